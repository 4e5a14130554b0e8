//! What follows from one actuator: an order at a time, and none beyond the end.
//!
//! A bistable actuator's outputs are never both TRUE; the one that comes second gives way, and both do if
//! they come together. An order ends where the end is reached: it is not given there (the constraint
//! Xuc·↑Ec of the paper on validation filters), and given up in the very scan that reaches it (Xc·↑Euc). The level form says both at
//! once and loses no edge.
//!
//! The output of a monostable actuator stays TRUE at its end, and an on/off one has no ends: nothing follows.

use super::{Derived, derived, reached, rise, sensor, value};
use crate::ir::ast::{Actuator, Name, Position, Technology};

pub fn of(actuator: &Actuator) -> Vec<Derived> {
    let (Technology::Bistable, [first, second]) = (actuator.technology, actuator.positions.as_slice()) else {
        return Vec::new();
    };
    let (Some(back), Some(out)) = (&first.output, &second.output) else { return Vec::new() };
    let mut all = vec![together(actuator, back, out), together(actuator, out, back)];
    for (position, output) in [(first, back), (second, out)] {
        all.extend(end(actuator, position, output));
    }
    all
}

fn together(actuator: &Actuator, coming: &Name, other: &Name) -> Derived {
    let span = actuator.name.span;
    let parts = vec![rise(coming, span), value(other, span)];
    let text = format!("{} gets one order at a time", actuator.name.text);
    derived(&actuator.name, format!("Both_{}_{}", coming.text, other.text), parts, Some(coming), text)
}

fn end(actuator: &Actuator, position: &Position, output: &Name) -> Vec<Derived> {
    let Some(guard) = &position.sensor else { return Vec::new() };
    let span = actuator.name.span;
    let there = format!("{} is {}", actuator.name.text, position.name.text);
    let forms = [
        (false, "End", vec![value(output, span), sensor(guard, span)], format!("{there}: no order any more")),
        (true, "Start", vec![rise(output, span), sensor(guard, span)], format!("{there} already")),
        (true, "Stop", vec![value(output, span), reached(guard, span)], format!("{there}: the order ends at once")),
    ];
    let one = |(edges, word, parts, text)| {
        let d = derived(&actuator.name, format!("{word}_{}", output.text), parts, None, text);
        Derived { edges: Some(edges), ..d }
    };
    forms.into_iter().map(one).collect()
}
