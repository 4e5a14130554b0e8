//! What several tests share.

pub mod binary;
pub mod charts;
pub mod damage;
pub mod direct;
pub mod generate;
pub mod models;
pub mod plc;
pub mod read;
pub mod schema;
