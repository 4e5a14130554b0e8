//! The text form of the intermediate representations: what snapshots hold and people review.
