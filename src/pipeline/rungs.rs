//! A run of a machine to the rungs that drove its outputs in the last scan, with what every contact was.

use crate::emit::{self, Dialect, Header};
use crate::ir::chart::{Machine, OutputId};
use crate::ir::iec;
use crate::ir::ladder::Rung;
use crate::ir::plc::{Body, GlobalId, Origin, Project, Role};
use crate::ir::text;
use crate::read;
use crate::simulate::frame::{Frame, Layout};
use crate::simulate::plc::Plc;
use crate::simulate::run::milliseconds;
use std::collections::BTreeMap;

/// The rungs of these outputs, and of their commands, with the values with which they were executed in the last
/// scan. Nothing if the program does not do what the frames say: then times pass in them as no PLC lets them pass.
pub fn show(machine: &Machine, frames: &[Frame], outputs: &[OutputId]) -> Option<String> {
    let project = super::lower(machine);
    let (read, _) = read::read(&emit::plcopen(&project, Dialect::Beremiz, &Header::default()));
    let read = read?;
    let layout = Layout::of(machine);
    let variables: BTreeMap<&str, iec::VarId> =
        read.variables.iter().filter(|(_, v)| v.scope == iec::Scope::Global).map(|(id, v)| (&*v.name, id)).collect();
    let variable = |g: GlobalId| variables.get(&*project.globals[g].name).copied();
    let find = |role: Role, origin: Origin| {
        project.globals.iter().find(|(_, g)| g.role == role && g.origin == origin).map(|(id, _)| id)
    };
    let mut inputs = Vec::new();
    for id in machine.inputs.ids() {
        inputs.push((layout.input(id), variable(find(Role::Input, Origin::Input(id))?)?));
    }
    let mut plc = Plc::new(&read);
    let mut before = plc.clone();
    for (frame, scan) in frames.iter().zip(1..) {
        if scan == frames.len() as u64 {
            before = plc.clone();
        }
        inputs.iter().for_each(|&(place, v)| plc.write(v, i64::from(frame[place])));
        plc.scan(i64::try_from(milliseconds(machine, scan)).ok()?.saturating_mul(1000));
    }
    let last = frames.last()?;
    let written = written(&project);
    let mut coils = Vec::new();
    for &output in outputs {
        let coil = find(Role::Output, Origin::Output(output))?;
        if (plc.read(variable(coil)?) != 0) != last[layout.output(output)] {
            return None;
        }
        coils.push(coil);
        coils.extend(find(Role::Command, Origin::Output(output)));
    }
    let mut out = String::new();
    let mut position = 0;
    for program in &project.programs {
        position += 1;
        let Body::Ladder(ladder) = &program.body else { continue };
        for rung in &ladder.rungs {
            position += 1;
            if !coils.contains(&rung.coil) {
                continue;
            }
            // What is written further down had its value of the scan before.
            let value = |g: GlobalId| {
                let late = g != rung.coil && written.get(&g).is_some_and(|&first| first > position);
                let plc = if late { &before } else { &plc };
                variable(g).map_or(0, |v| plc.read(v))
            };
            if is_consistent(rung, &value) {
                out += &text::rung_with(&project, rung, &value);
            }
        }
    }
    (!out.is_empty()).then_some(out)
}

/// Where each variable is first written in a scan, programs and rungs counted in their order.
fn written(project: &Project) -> BTreeMap<GlobalId, usize> {
    let mut first = BTreeMap::new();
    let mut position = 0;
    for program in &project.programs {
        position += 1;
        match &program.body {
            Body::Sfc(sfc) => sfc.steps.values().filter_map(|s| s.flag).for_each(|flag| {
                first.entry(flag).or_insert(position);
            }),
            Body::Ladder(ladder) => {
                for rung in &ladder.rungs {
                    position += 1;
                    first.entry(rung.coil).or_insert(position);
                }
            }
        }
    }
    first
}

/// Whether these values make the coil what it is: what is shown is to explain it.
fn is_consistent(rung: &Rung, value: &dyn Fn(GlobalId) -> i64) -> bool {
    let holds = |p: &crate::ir::sop::Product<GlobalId>| p.literals().iter().all(|l| (value(l.atom) != 0) != l.negated);
    let plain = rung.timer.is_none() && rung.function.is_none();
    plain && rung.condition.products().iter().any(holds) == (value(rung.coil) != 0)
}
