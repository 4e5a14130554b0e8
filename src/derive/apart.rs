//! What follows from positions of two actuators that are forbidden together.
//!
//! Each actuator is at its first position, between, or at its second: nine combinations, some of them
//! forbidden. Sensors are read once per scan, and between two readings an actuator can go any way along its
//! order; so an order counts as if it led to its end at once. With that, four rules keep what is forbidden
//! out of reach (their numbers in the paper's table of the prehensor):
//!
//! - *way* (K11 to K13): an order is not given while the other actuator stands where this order would lead
//!   into what is forbidden. For the bistable actuator that `forbid` names first, it is not kept up either;
//! - *with* (K14): of two orders that lead there together, the one that comes gives way;
//! - *after* (K15): nor does it come in the scan after the other one, whose effect the sensors do not show yet;
//! - *hold* (H1 to H3): a valve that remembers its order goes on without it. So the order stays until the end
//!   is reached, and the rules above see it. A closed-centre valve stops without its order.
//!
//! A monostable actuator is ordered back when its output falls, so there the same rules hold the output on.

use super::{Condition, Derived, before, derived, fall, rise, sensor, value};
use crate::base::{Code, Diagnostic, Diagnostics, Span};
use crate::ir::ast::{self, Actuator, Forbid, Guard, Name, Place, Technology, Valve};
use crate::ir::expr::Expr;
use std::collections::{BTreeMap, BTreeSet};

/// Where an actuator can be: at its first position, between, at its second.
const ZONES: [usize; 3] = [0, 1, 2];

pub fn of(tree: &ast::Machine, diagnostics: &mut Diagnostics) -> Vec<Derived> {
    let mut all = Vec::new();
    let mut orders: BTreeMap<(usize, usize), Held<'_>> = BTreeMap::new();
    for forbid in tree.safety.iter().flat_map(|s| &s.forbids) {
        if let Some(pair) = Pair::of(tree, forbid, diagnostics) {
            pair.derive(&mut all, &mut orders);
        }
    }
    all.extend(orders.into_values().filter_map(Held::derive));
    all
}

/// An actuator of a pair.
#[derive(Clone, Copy)]
struct Member<'a> {
    index: usize,
    actuator: &'a Actuator,
    /// The sensors of its two ends.
    sensors: [&'a Guard; 2],
}

/// An order to an actuator: a way that it can be sent.
#[derive(Clone, Copy)]
struct Order<'a> {
    member: Member<'a>,
    output: &'a Name,
    /// The zone to which it leads.
    to: usize,
    /// Whether it is the spring that leads there, while the output is FALSE.
    spring: bool,
    /// Whether rules may end it while it works, not only keep it from beginning.
    level: bool,
}

impl<'a> Order<'a> {
    /// The zones through which it can lead from one, to the end.
    fn reach(&self, from: usize) -> impl Iterator<Item = usize> + use<> {
        let to = self.to;
        ZONES.into_iter().filter(move |&z| if to == 2 { z > from } else { z < from })
    }

    /// It begins.
    fn begins(&self, span: Span) -> Condition {
        if self.spring { fall(self.output, span) } else { rise(self.output, span) }
    }

    /// It is given in this scan, or it begins where one cannot tell from the output that it works.
    fn given(&self, span: Span) -> Condition {
        match self.member.actuator.technology {
            Technology::Bistable => value(self.output, span),
            _ => self.begins(span),
        }
    }

    /// It was given in the scan before, and may still be working.
    fn was_given(&self, span: Span) -> Condition {
        let before = before(self.output, span);
        match self.member.actuator.technology {
            Technology::Bistable => before,
            _ => {
                let there = sensor(self.member.sensors[self.to / 2], span);
                Expr::all([if self.spring { before.not() } else { before }, there.not()])
            }
        }
    }

    fn name(&self) -> String {
        format!("{}{}", self.output.text, if self.spring { "_back" } else { "" })
    }

    /// The order in words.
    fn words(&self) -> String {
        let position = &self.member.actuator.positions[self.to / 2].name.text;
        format!("{} goes {position}", self.member.actuator.name.text)
    }
}

impl<'a> Member<'a> {
    fn orders(&self, level: bool) -> Vec<Order<'a>> {
        let outputs = self.actuator.positions.iter().map(|p| p.output.as_ref());
        match (self.actuator.technology, outputs.collect::<Vec<_>>().as_slice()) {
            (Technology::Bistable, [Some(back), Some(out)]) => [(*back, 0), (*out, 2)]
                .map(|(output, to)| Order { member: *self, output, to, spring: false, level })
                .into(),
            (Technology::Monostable, [None, Some(out)]) => [(0, true), (2, false)]
                .map(|(to, spring)| Order { member: *self, output: out, to, spring, level: false })
                .into(),
            _ => Vec::new(), // Resolving refuses such a shape.
        }
    }

    /// The actuator is in one of these zones.
    fn within(&self, zones: &[usize], span: Span) -> Condition {
        let [first, second] = self.sensors.map(|s| sensor(s, span));
        match zones {
            [] => Expr::FALSE,
            [0] => first,
            [1] => Expr::all([first.not(), second.not()]),
            [2] => second,
            [0, 1] => second.not(),
            [1, 2] => first.not(),
            [0, 2] => Expr::any([first, second]),
            _ => Expr::TRUE,
        }
    }
}

/// Two actuators, and which of their zones are forbidden together.
struct Pair<'a> {
    forbid: &'a Forbid,
    members: [Member<'a>; 2],
    forbidden: [[bool; 3]; 3],
}

impl<'a> Pair<'a> {
    fn of(tree: &'a ast::Machine, forbid: &'a Forbid, diagnostics: &mut Diagnostics) -> Option<Self> {
        let first = member(tree, &forbid.first, diagnostics);
        let second = member(tree, &forbid.second, diagnostics);
        let ((first, of_first), (second, of_second)) = (first?, second?);
        if first.index == second.index {
            let d = Diagnostic::new(Code::BadForbid, format!("`{}` speaks of one actuator twice", forbid.name.text))
                .label(forbid.second.actuator.span, "the same as before")
                .help("forbid what two actuators must not do together");
            diagnostics.push(d);
            return None;
        }
        let forbidden = ZONES.map(|a| ZONES.map(|b| a == of_first && (b == of_second) != forbid.unless));
        Some(Pair { forbid, members: [first, second], forbidden })
    }

    fn is_forbidden(&self, which: usize, zone: usize, other: usize) -> bool {
        if which == 0 { self.forbidden[zone][other] } else { self.forbidden[other][zone] }
    }

    /// The zones of the other actuator in which an order to this one would lead into what is forbidden.
    fn bad(&self, which: usize, order: &Order<'_>) -> Vec<usize> {
        let leads = |other: usize| {
            ZONES.into_iter().any(|from| {
                !self.is_forbidden(which, from, other)
                    && order.reach(from).any(|to| self.is_forbidden(which, to, other))
            })
        };
        ZONES.into_iter().filter(|&other| leads(other)).collect()
    }

    fn derive(&self, all: &mut Vec<Derived>, held: &mut BTreeMap<(usize, usize), Held<'a>>) {
        let source = &self.forbid.name;
        let reason = self.forbid.text.as_ref().map(|t| format!(": {}", t.value)).unwrap_or_default();
        let span = source.span;
        let orders = [self.members[0].orders(true), self.members[1].orders(false)];
        let bad = [0, 1].map(|w| orders[w].iter().map(|o| self.bad(w, o)).collect::<Vec<_>>());
        let mut dangerous = |order: &Order<'a>, end: Option<(Member<'a>, &[usize])>| {
            let held = held.entry((order.member.index, order.to)).or_insert(Held {
                order: *order,
                ends: Vec::new(),
                sources: Vec::new(),
            });
            held.ends.extend(end.map(|(other, zones)| (other, zones.to_vec())));
            if !held.sources.contains(&source) {
                held.sources.push(source);
            }
        };
        for which in [0, 1] {
            for (order, zones) in orders[which].iter().zip(&bad[which]).filter(|(_, zones)| !zones.is_empty()) {
                let other = self.members[1 - which];
                let begins = if order.level { value(order.output, span) } else { order.begins(span) };
                let text = format!("{}{reason}", order.words());
                let name = format!("{}_{}", source.text, order.name());
                all.push(derived(source, name, vec![begins, other.within(zones, span)], None, text));
                dangerous(order, order.level.then_some((other, zones.as_slice())));
            }
        }
        for (a, bad_a) in orders[0].iter().zip(&bad[0]) {
            for (b, bad_b) in orders[1].iter().zip(&bad[1]) {
                let meet = ZONES.into_iter().any(|x| {
                    ZONES.into_iter().any(|y| {
                        let may = !self.forbidden[x][y] && !bad_a.contains(&y) && !bad_b.contains(&x);
                        may && a.reach(x).any(|to| b.reach(y).any(|other| self.forbidden[to][other]))
                    })
                });
                if !meet {
                    continue;
                }
                dangerous(a, None);
                dangerous(b, None);
                for (coming, other) in [(a, b), (b, a)] {
                    let text = format!("not {} and {} at once{reason}", coming.words(), other.words());
                    let name = format!("{}_{}_with_{}", source.text, coming.name(), other.name());
                    let parts = vec![coming.begins(span), other.given(span)];
                    all.push(derived(source, name, parts, Some(coming.output), text));
                    let text = format!("{} a scan after {}{reason}", coming.words(), other.words());
                    let name = format!("{}_{}_after_{}", source.text, coming.name(), other.name());
                    let parts = vec![coming.begins(span), other.was_given(span)];
                    all.push(derived(source, name, parts, None, text));
                }
            }
        }
    }
}

/// An order that has to stay until its end is reached, and what ends it before.
struct Held<'a> {
    order: Order<'a>,
    /// Other actuators and the zones of theirs in which the order is taken back.
    ends: Vec<(Member<'a>, Vec<usize>)>,
    /// The forbidden positions that need it.
    sources: Vec<&'a Name>,
}

impl Held<'_> {
    fn derive(self) -> Option<Derived> {
        let (order, actuator) = (self.order, self.order.member.actuator);
        let mut taken: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        self.ends.iter().for_each(|(other, zones)| taken.entry(other.index).or_default().extend(zones));
        // What is never allowed need not be held.
        let never = taken.values().any(|zones| zones.len() == ZONES.len());
        if never || !matches!(actuator.valve, Some((Valve::Memory, _))) {
            return None;
        }
        let span = actuator.name.span;
        let there = sensor(order.member.sensors[order.to / 2], span);
        // Each as it is written there, so that a sensor that lies cannot make both demands at once.
        let ends = self.ends.iter().map(|(other, zones)| other.within(zones, span).not());
        let parts = [fall(order.output, span), there.not()].into_iter().chain(ends).collect();
        let text = format!("{} until it is there: the valve remembers", order.words());
        let mut d = derived(&actuator.name, format!("Hold_{}", order.output.text), parts, None, text);
        d.constraint.from.extend(self.sources.into_iter().cloned());
        Some(d)
    }
}

/// The actuator of a place and its zone there; reports what is no place or says too little.
fn member<'a>(tree: &'a ast::Machine, place: &Place, diagnostics: &mut Diagnostics) -> Option<(Member<'a>, usize)> {
    let same = |a: &str, b: &str| a.eq_ignore_ascii_case(b);
    let found = tree.actuators.iter().position(|a| same(&a.name.text, &place.actuator.text));
    let Some(index) = found else {
        let text = format!("there is no actuator `{}`", place.actuator.text);
        diagnostics.push(Diagnostic::new(Code::UnknownName, text).label(place.actuator.span, "not declared"));
        return None;
    };
    let actuator = &tree.actuators[index];
    let name = &actuator.name.text;
    let mut refuse = |code, text: String, label: &str, help: String| {
        let d = Diagnostic::new(code, text).label(place.actuator.span, label);
        diagnostics.push(d.label(actuator.name.span, "declared here").help(help));
    };
    let sensors: Vec<&Guard> = actuator.positions.iter().filter_map(|p| p.sensor.as_ref()).collect();
    let (Technology::Bistable | Technology::Monostable, [first, second]) = (actuator.technology, sensors.as_slice())
    else {
        let help = "it has to be bistable or monostable, with a sensor at each of its two positions".to_owned();
        refuse(Code::BadForbid, format!("where `{name}` is cannot be told"), "its place is forbidden", help);
        return None;
    };
    if actuator.technology == Technology::Bistable && actuator.valve.is_none() {
        let help = format!("write `actuator {name} bistable valve closed-centre` or `… valve memory`");
        let text = format!("what `{name}` does without an order is not said");
        refuse(Code::ValveNeeded, text, "what keeps it away depends on that", help);
        return None;
    }
    let zone = match &place.position {
        None => 1,
        Some(position) => match actuator.positions.iter().position(|p| same(&p.name.text, &position.text)) {
            Some(i) => 2 * i,
            None => {
                let text = format!("`{name}` has no position `{}`", position.text);
                diagnostics.push(Diagnostic::new(Code::UnknownName, text).label(position.span, "not declared"));
                return None;
            }
        },
    };
    Some((Member { index, actuator, sensors: [first, second] }, zone))
}
