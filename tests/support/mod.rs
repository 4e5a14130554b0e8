//! What several tests share.

pub mod binary;
pub mod charts;
pub mod damage;
pub mod explorer;
pub mod filters;
pub mod items;
pub mod model_damage;
pub mod models;
pub mod numbers;
pub mod plc;
pub mod proof;
pub mod random;
pub mod read;
pub mod rng;
pub mod runs;
pub mod schema;
pub mod shrink;
pub mod small;
pub mod st;
pub mod systems;
pub mod xml_damage;
pub mod xml_edit;
pub mod xsd;
