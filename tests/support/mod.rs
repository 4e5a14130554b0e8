//! What several tests share.

pub mod plc;
pub mod schema;
