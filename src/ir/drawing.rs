//! Drawings: where the elements of an SFC or a ladder stand on a page.
