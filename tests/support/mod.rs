//! What several tests share.

pub mod binary;
pub mod charts;
pub mod items;
pub mod damage;
pub mod direct;
pub mod generate;
pub mod models;
pub mod plc;
pub mod random;
pub mod read;
pub mod rng;
pub mod runs;
pub mod schema;
pub mod shrink;
