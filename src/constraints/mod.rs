//! Machine to what is to be known about its safety constraints.
//!
//! | module | does |
//! | --- | --- |
//! | [`questions`] | asks a solver what the filter may meet |
//! | [`properties`] | whether it can always meet all constraints |
//! | [`sweeps`] | how many sweeps `relief in-order` takes |
//! | [`safe`] | whether any outputs meet all constraints |
//! | [`words`] | products in the words of the model |

pub mod properties;
pub mod questions;
pub mod safe;
pub mod sweeps;
pub mod words;
