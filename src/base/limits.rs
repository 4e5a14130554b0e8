//! The stated limits of what the compiler takes. They bound time and memory; the stack bounds nothing.

/// Largest source file, in bytes.
pub const SOURCE_BYTES: usize = 16 * 1024 * 1024;

/// Largest PLC project that is read, in bytes. Programs are some hundred times as long as models.
pub const PROGRAM_BYTES: usize = 512 * 1024 * 1024;

/// Deepest nesting of `{` and of `(` in a source file.
pub const NESTING: usize = 64;

/// Most states of one region, movements counted. A region becomes one SFC, and with its idle step it
/// has to stay within the 150 steps that PLC code generators still take in reasonable time.
pub const REGION_STATES: usize = 149;

/// Most transitions of one region, those that `from any` stands for counted one by one. Each is drawn,
/// and a program of that size is at the end of what a person and an IDE can take.
pub const REGION_TRANSITIONS: usize = 1_000;

/// Most ways that lead through choices from one place, and most choices on one way.
pub const WAYS: usize = 64;

/// Longest name that a model may give anything, in characters.
pub const NAME_LENGTH: usize = 48;

/// Longest name that the compiler gives anything in a PLC project, in characters.
pub const PLC_NAME_LENGTH: usize = 64;

/// Most products that one safety constraint may split into.
pub const CONSTRAINT_PRODUCTS: usize = 64;

/// Most constants and variables of one integer expression.
pub const OPERANDS: usize = 32;

/// Most errors that one run reports; the rest is counted.
pub const REPORTED_ERRORS: usize = 50;

/// Longest time of a plant or scenario, in scans, longest scenario with all that it repeats, and longest
/// run that is recorded.
pub const SCENARIO_SCANS: u32 = 1_000_000;

/// Most sweeps that reliefs in order may take: all of them are written out as rungs.
pub const SWEEPS: usize = 32;
