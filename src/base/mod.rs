//! What every layer may use and what knows nothing of machines: spans, arenas, diagnostics, names.

pub mod arena;
pub mod counted;
pub mod diagnostic;
pub mod iec;
pub mod limits;
pub mod span;
pub mod words;

pub use arena::{Arena, Id};
pub use counted::{count, figure};
pub use diagnostic::{Code, Diagnostic, Diagnostics, Label, Severity};
pub use span::{LineIndex, Span};
