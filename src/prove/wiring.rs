//! Whether a program is wired and scheduled as its machine is.
//!
//! That a variable holds what an output should be is worth nothing if another coil of the machine hangs
//! on its address, or if it runs once a minute. Neither shows in any scan, so both are compared before.

use super::correspondence::Correspondence;
use crate::base::iec;
use crate::ir::chart::Machine;
use crate::ir::iec::{Project, Scope};
use std::collections::{BTreeMap, BTreeSet};

/// Says where the addresses or the time between two scans differ, if they do.
pub fn compare(machine: &Machine, names: &Correspondence, project: &Project) -> Result<(), String> {
    scheduled(machine, project)?;
    let inputs = machine.inputs.values().zip(&names.inputs).map(|(i, n)| (n, ('I', i.name.as_str(), &i.address)));
    let outputs = machine.outputs.values().zip(&names.outputs).map(|(o, n)| (n, ('Q', o.name.as_str(), &o.address)));
    let signals: BTreeMap<String, _> = inputs.chain(outputs).map(|(n, signal)| (iec::fold(n), signal)).collect();
    let mut taken = BTreeSet::new();
    for variable in project.variables.values() {
        let signal = signals.get(&iec::fold(&variable.name)).filter(|_| variable.scope == Scope::Global);
        let Some(&(area, name, wanted)) = signal else {
            match &variable.address {
                Some(address) => {
                    let what = "which is no input or output of the machine";
                    return Err(format!("the program has `{}` at the address {address}, {what}", variable.name));
                }
                None => continue,
            }
        };
        let kind = if area == 'I' { "input" } else { "output" };
        // Nothing has been commanded yet, and some PLCs show what a program begins with.
        if area == 'Q' && variable.initial != 0 {
            return Err(format!("output {name} is TRUE before the first scan"));
        }
        let found = match &variable.address {
            None => None,
            Some(written) => {
                let found = iec::bit_address(written, area)
                    .ok_or_else(|| format!("{written}, the address of {kind} {name}, is not that of an {kind}"))?;
                if !taken.insert(found.clone()) {
                    return Err(format!("two variables of the program have the address {found}"));
                }
                Some(found)
            }
        };
        // A model without an address leaves it to the program.
        if let Some(wanted) = wanted
            && found.as_ref() != Some(wanted)
        {
            let found = found.map_or("nowhere".to_owned(), |found| format!("at {found}"));
            return Err(format!("{kind} {name} is at {wanted} in the model and {found} in the program"));
        }
    }
    Ok(())
}

fn scheduled(machine: &Machine, project: &Project) -> Result<(), String> {
    let wanted = i64::from(machine.cycle) * 1000;
    match project.tick() {
        Some(tick) if tick == wanted => Ok(()),
        Some(tick) => {
            let ms = tick as f64 / 1000.0;
            Err(format!("the program runs every {ms} ms, the model says {} ms", machine.cycle))
        }
        None => Err("no task says in which order the programs run, and how often".to_owned()),
    }
}
