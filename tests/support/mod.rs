//! What several tests share.

pub mod binary;
pub mod models;
pub mod plc;
pub mod schema;
