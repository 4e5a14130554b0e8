//! A run with exact times to the shortest one that shows the same, where the first scans tell.

use crate::verify::bounded::Bounded;
use crate::verify::limits::Stop;
use crate::verify::machine::Subject;
use crate::verify::system::{Property, Trace};

/// Scans of a run that is still looked at: a longer one takes longer to be sure than it is worth.
const SCANS: usize = 60;

/// Conflicts of the solver for one scan.
const QUESTION: u64 = 5_000;

/// Conflicts for all of them.
const CONFLICTS: u64 = 20_000;

/// The shortest run, scan by scan, that shows the same of a property that says what never is; the same run where that is not known.
pub fn shortest(subject: &Subject<'_>, property: Property, trace: Trace, stop: Stop<'_>) -> Trace {
    let Property::Never(bad) = property else { return trace };
    if trace.shortest {
        return trace;
    }
    let whole = subject.stretched(&trace, property);
    if whole.inputs.len() > SCANS {
        return trace;
    }
    let mut system = subject.system.clone();
    system.constraints.push(!subject.clocks.leap);
    let mut bounded = Bounded::new(&system, &[bad], stop);
    let scans = whole.inputs.len().saturating_sub(1);
    let shows = |run: &Trace| subject.system.shows(run, property);
    match bounded.soonest(scans, (CONFLICTS, QUESTION), stop, shows) {
        Some((Some(run), sure)) => Trace { shortest: sure, ..run },
        Some((None, sure)) => Trace { shortest: sure, ..whole },
        None => trace,
    }
}
