//! The text form of a machine: what each name has become, with scopes, technology drives and
//! products spelt out.

use super::chart::*;
use super::expr::CHART;
use super::scenario::{Alteration, Condition, CountId, Doing, Given, PropertyKind, Step};
use super::sop::Product;
use crate::base::figure;
use std::fmt::{self, Write};

/// Writes the machine as an outline.
pub fn outline(machine: &Machine) -> String {
    let scoped = [Phase::Start, Phase::End].map(|p| machine.scoped(p));
    let mut w = Writer { machine, scoped, internals: machine.internals(), out: String::new() };
    w.whole().expect("writing to a string succeeds");
    w.out
}

struct Writer<'m> {
    machine: &'m Machine,
    /// By phase and region.
    scoped: [Vec<Vec<TransitionId>>; 2],
    internals: Vec<Vec<TransitionId>>,
    out: String,
}

impl Writer<'_> {
    fn whole(&mut self) -> fmt::Result {
        let m = self.machine;
        writeln!(self.out, "machine {}, cycle {} ms", m.name, m.cycle)?;
        for i in m.inputs.values() {
            writeln!(self.out, "input {} {}", i.name, i.address.as_deref().unwrap_or("-"))?;
        }
        for o in m.outputs.values() {
            writeln!(self.out, "output {} {}", o.name, o.address.as_deref().unwrap_or("-"))?;
        }
        for e in m.events.values() {
            writeln!(self.out, "event {}", e.name)?;
        }
        for v in m.variables.values() {
            writeln!(self.out, "variable {} := {}", v.name, v.initial)?;
        }
        for i in m.integers.values() {
            writeln!(self.out, "integer {} {}..{} := {}", i.name, i.range.lowest, i.range.highest, i.initial)?;
        }
        for a in m.actuators.values() {
            let positions: Vec<String> = a
                .positions
                .iter()
                .map(|p| {
                    let output = p.output.map(|o| format!(" by {}", m.outputs[o].name)).unwrap_or_default();
                    let sensor = p.sensor.as_ref().map(|g| format!(" at {}", self.guard(g))).unwrap_or_default();
                    format!("{}{output}{sensor}", p.name)
                })
                .collect();
            writeln!(self.out, "actuator {} {:?}: {}", a.name, a.technology, positions.join(", "))?;
        }
        for chart in &m.charts {
            let kind = match chart.kind {
                ChartKind::Observer => "observer",
                ChartKind::Control => "chart",
            };
            writeln!(self.out, "{kind} {}", chart.name)?;
            for &r in &chart.regions {
                self.region(r, 1)?;
            }
        }
        if let Some(mode) = m.safety.mode {
            let relief = match m.safety.relief {
                Relief::Together => String::new(),
                Relief::InOrder { sweeps } => format!(", relief in order, {}", figure(sweeps, "sweep")),
            };
            let reset = m.safety.reset.map(|i| format!(", reset by {}", m.inputs[i].name)).unwrap_or_default();
            writeln!(self.out, "filter {mode:?}{relief}{reset}")?;
        }
        for a in &m.safety.assumptions {
            writeln!(self.out, "assume {}: {} = 0", a.name, self.products(&a.products))?;
        }
        for c in m.safety.constraints.values() {
            let yields: Vec<&str> = c.yields.iter().map(|&o| m.outputs[o].name.as_str()).collect();
            let yields = if yields.is_empty() { String::new() } else { format!(", yields {}", yields.join(" and ")) };
            let kind = if c.products.iter().any(|p| outputs_of(p).count() > 1) { "combined" } else { "simple" };
            writeln!(self.out, "{kind} {}: {} = 0{yields}", c.name, self.products(&c.products))?;
        }
        for p in &m.properties {
            let word = if p.kind == PropertyKind::Fair { "fairness" } else { "property" };
            let holds = self.condition(&p.condition);
            match &p.after {
                Some(after) => {
                    writeln!(self.out, "{word} {}: after {} eventually {holds}", p.name, self.condition(after))?;
                }
                None => writeln!(self.out, "{word} {}: {} {holds}", p.name, p.kind.words())?,
            }
        }
        m.accepted.iter().try_for_each(|a| writeln!(self.out, "{}", a.written))?;
        self.plant()?;
        for s in &m.scenarios {
            let after = s.after.map(|a| format!(" after {:?}", m.scenarios[a].name)).unwrap_or_default();
            writeln!(self.out, "scenario {:?}{after}", s.name)?;
            self.steps(&s.steps, 1)?;
        }
        Ok(())
    }

    fn plant(&mut self) -> fmt::Result {
        let m = self.machine;
        for b in m.plant.bits.values() {
            writeln!(self.out, "hidden {}", b.name)?;
        }
        for c in m.plant.counts.values() {
            writeln!(self.out, "hidden {}: {}..{} := {}", c.name, c.range.lowest, c.range.highest, c.initial)?;
        }
        if m.plant.by_steps {
            writeln!(self.out, "by steps")?;
        }
        for h in &m.plant.happenings {
            writeln!(self.out, "step {:?} when {}", h.text, self.condition(&h.condition))?;
            let name = |c: &CountId| m.plant.counts[*c].name.as_str();
            for outcome in &h.outcomes {
                let condition = self.condition(&outcome.condition);
                match &outcome.change {
                    Alteration::Bit(b, value) => {
                        writeln!(self.out, "  {} := {value} when {condition}", m.plant.bits[*b].name)?;
                    }
                    Alteration::Count(c, value) => {
                        write!(self.out, "  {} := ", name(c))?;
                        value.write(&mut self.out, &mut |c, f| f.write_str(name(c)))?;
                        writeln!(self.out, " when {condition}")?;
                    }
                }
            }
        }
        for &bit in &m.plant.unknown {
            writeln!(self.out, "initially any {}", m.plant.bits[bit].name)?;
        }
        for &(given, value) in &m.plant.initially {
            writeln!(self.out, "initially {} := {value}", m.given(given))?;
        }
        for &(actuator, position) in &m.plant.places {
            writeln!(self.out, "initially {}", self.place(actuator, position))?;
        }
        for t in &m.plant.travels {
            let sensors: Vec<String> = t
                .sensors
                .iter()
                .map(|s| {
                    let position = &m.actuators[t.actuator].positions[s.position].name;
                    format!("{}{} at {position}", if s.there { "" } else { "not " }, m.inputs[s.input].name)
                })
                .collect();
            let (name, sensors) = (&m.actuators[t.actuator].name, sensors.join(", "));
            let power = self.condition(&t.power);
            let most = if t.at_most { "at most " } else { "" };
            writeln!(
                self.out,
                "travel {name} {:?}: {most}{} scans out, {} back, when {power}: {sensors}",
                t.valve, t.out, t.back
            )?;
        }
        for r in &m.plant.rules {
            let (name, condition) = (m.given(r.target), self.condition(&r.condition));
            writeln!(self.out, "rule {name} := {} when {condition} after {} scans", r.value, r.delay)?;
        }
        Ok(())
    }

    fn steps(&mut self, steps: &[Step], depth: usize) -> fmt::Result {
        let m = self.machine;
        for step in steps {
            let values = |list: &[(Given, bool)]| {
                list.iter().map(|&(g, v)| format!("{} := {v}", m.given(g))).collect::<Vec<_>>().join(", ")
            };
            let line = match &step.doing {
                Doing::Set(list) => format!("set {}", values(list)),
                Doing::Press(list, scans) => {
                    let names: Vec<&str> = list.iter().map(|&g| m.given(g)).collect();
                    format!("press {} for {}", names.join(", "), figure(scans, "scan"))
                }
                Doing::Force(list) => {
                    format!("force {}", values(&list.iter().map(|&(i, v)| (Given::Input(i), v)).collect::<Vec<_>>()))
                }
                Doing::Release(list) => {
                    let names: Vec<&str> = list.iter().map(|&i| m.inputs[i].name.as_str()).collect();
                    format!("release {}", names.join(", "))
                }
                Doing::Place(actuator, position) => format!("place {}", self.place(*actuator, *position)),
                Doing::Happens(None) => "happens nothing".to_owned(),
                Doing::Happens(Some(told)) => {
                    let when = if told.before_writing { " before writing" } else { "" };
                    format!("happens {}{when}", m.plant.happenings[told.happening].text)
                }
                Doing::Wait(scans) => format!("wait {}", figure(scans, "scan")),
                Doing::Until(c, scans) => format!("until {} within {}", self.condition(c), figure(scans, "scan")),
                Doing::Expect(c) => format!("expect {}", self.condition(c)),
                Doing::Watch(c, value) => format!("{} {}", if *value { "always" } else { "never" }, self.condition(c)),
                Doing::Repeat(times, _) => format!("repeat {}", figure(times, "time")),
            };
            writeln!(self.out, "{:1$}{line}", "", depth * 2)?;
            if let Doing::Repeat(_, inner) = &step.doing {
                self.steps(inner, depth + 1)?;
            }
        }
        Ok(())
    }

    fn place(&self, actuator: ActuatorId, position: usize) -> String {
        let actuator = &self.machine.actuators[actuator];
        format!("{} at {}", actuator.name, actuator.positions[position].name)
    }

    fn condition(&self, condition: &Condition) -> String {
        let mut out = String::new();
        let written = condition.write(&mut out, &CHART, &mut |a, f| f.write_str(&self.machine.seen(*a)));
        written.expect("writing to a string succeeds");
        out
    }

    fn region(&mut self, id: RegionId, depth: usize) -> fmt::Result {
        let m = self.machine;
        let region = &m.regions[id];
        let mut depth = depth;
        if region.name.is_some() || region.actuator.is_some() {
            let name = region.name.as_deref().unwrap_or("-");
            let controls = region.actuator.map(|a| format!(" controls {}", m.actuators[a].name)).unwrap_or_default();
            writeln!(self.out, "{:1$}region {name}{controls}", "", depth * 2)?;
            depth += 1;
        }
        for (guard, s) in &region.entries {
            writeln!(self.out, "{:1$}begins at {2} when {3}", "", depth * 2, m.states[*s].name, self.guard(guard))?;
        }
        for &s in &region.states {
            let state = &m.states[s];
            let initial = if region.initial == s { "initial " } else { "" };
            let at =
                state.position.zip(region.actuator).map(|(p, a)| format!(" at {}", m.actuators[a].positions[p].name));
            let kind = match state.kind {
                StateKind::Elementary => "state".to_owned(),
                StateKind::Final => "final".to_owned(),
                StateKind::Movement { to } => {
                    let name = region.actuator.map(|a| m.actuators[a].positions[to].name.as_str());
                    format!("movement to {}:", name.unwrap_or("-"))
                }
                StateKind::Composite => "composite".to_owned(),
            };
            writeln!(self.out, "{:1$}{initial}{kind} {2}{3}", "", depth * 2, state.name, at.unwrap_or_default())?;
            for d in &state.drives {
                let by = if d.technology { " by technology" } else { "" };
                let output = &m.outputs[d.output].name;
                writeln!(self.out, "{:1$}drives {output} when {2}{by}", "", depth * 2 + 2, self.guard(&d.condition))?;
            }
            for a in &state.actions {
                let verb = if a.value { "sets" } else { "resets" };
                let variable = &m.variables[a.variable].name;
                writeln!(self.out, "{:1$}{verb} {variable} when {2}", "", depth * 2 + 2, self.guard(&a.condition))?;
            }
            for (word, deeds) in [("entry", &state.entry), ("exit", &state.exit)] {
                if !deeds.is_empty() {
                    writeln!(self.out, "{:1$}{word} {2}", "", depth * 2 + 2, self.deeds(deeds))?;
                }
            }
            for &t in &self.internals[s.index()] {
                let t = &m.transitions[t];
                let (guard, then) = (self.guard(&t.guard), self.deeds(&t.deeds));
                writeln!(self.out, "{:1$}internal when {guard} then {then}", "", depth * 2 + 2)?;
            }
            for &r in &state.regions {
                self.region(r, depth + 1)?;
            }
        }
        let [start, end] = &self.scoped;
        let ranked = |list: &[TransitionId]| list.iter().copied().enumerate().collect::<Vec<_>>();
        for (rank, id) in ranked(&start[id.index()]).into_iter().chain(ranked(&end[id.index()])) {
            let t = &m.transitions[id];
            let phase = if t.phase == Phase::End { "after filter " } else { "" };
            let then = if t.deeds.is_empty() { String::new() } else { format!(" then {}", self.deeds(&t.deeds)) };
            let (source, destination) = (m.state_path(t.source), m.destination(id));
            writeln!(
                self.out,
                "{:1$}{phase}{2}. {source} -> {destination} when {3}{then}",
                "",
                depth * 2,
                rank + 1,
                self.guard(&t.guard)
            )?;
        }
        Ok(())
    }

    fn deeds(&self, deeds: &Deeds) -> String {
        let name = |e: &Effect| &self.machine.variables[e.variable].name;
        let effects = deeds.effects.iter();
        let effects = effects.map(|e| format!("{} {}", if e.value { "set" } else { "reset" }, name(e)));
        let raises = deeds.raises.iter().map(|&e| format!("raise {}", self.machine.events[e].name));
        let integer = |a: &Assignment| &self.machine.integers[a.integer].name;
        let value = |a: &Assignment| format!("{} := {}", integer(a), self.machine.number(&a.value));
        effects.chain(raises).chain(deeds.assignments.iter().map(value)).collect::<Vec<_>>().join(", ")
    }

    fn guard(&self, guard: &Guard) -> String {
        let mut out = String::new();
        let written = guard.write(&mut out, &CHART, &mut |a, f| f.write_str(&self.machine.atom(*a)));
        written.expect("writing to a string succeeds");
        out
    }

    fn products(&self, products: &[Product<Atom>]) -> String {
        let literal = |l: &super::sop::Literal<Atom>| {
            format!("{}{}", if l.negated { "¬" } else { "" }, self.machine.atom(l.atom))
        };
        let product = |p: &Product<Atom>| p.literals().iter().map(literal).collect::<Vec<_>>().join("·");
        products.iter().map(product).collect::<Vec<_>>().join(" + ")
    }
}
