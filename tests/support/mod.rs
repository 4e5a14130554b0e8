//! What several tests share.

pub mod binary;
pub mod charts;
pub mod direct;
pub mod models;
pub mod plc;
pub mod read;
pub mod schema;
