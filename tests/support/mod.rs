//! What several tests share.

pub mod charts;
pub mod plc;
pub mod read;
pub mod schema;
