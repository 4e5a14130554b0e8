//! Names of the model to names of the PLC project.
//!
//! A generated name is a word that says what it is, `_`, and the path of what it stands for:
//! `X_Automatic_Preparation_V_Down`. It depends on nothing but that path, so unrelated edits leave
//! it alone. Where two paths read the same once dots have become underscores, where a name of the
//! model is in the way, or where the path is too long, the name ends in a hash of the path. A keyword that ends something
//! (`END_PROGRAM`) loses its underscore, wherever it stands.

use crate::base::{iec, limits, words};
use crate::ir::chart::{Machine, RegionId, StateId, TransitionId};
use std::collections::{BTreeMap, BTreeSet};

/// The names given so far, and the readable form of every path.
pub struct Names {
    taken: BTreeSet<String>,
    states: Vec<String>,
    regions: Vec<String>,
    transitions: Vec<String>,
}

impl Names {
    /// Takes the model's own names of signals and variables: they go into the project as they are.
    pub fn new(machine: &Machine) -> Names {
        let own = machine.inputs.values().map(|i| &i.name);
        let own = own.chain(machine.outputs.values().map(|o| &o.name));
        let own = own.chain(machine.variables.values().map(|v| &v.name));
        let own = own.chain(machine.events.values().map(|e| &e.name));
        let own = own.chain(machine.integers.values().map(|i| &i.name));
        let taken = own.map(|n| iec::fold(n)).collect();
        let paths: Vec<String> = machine.states.ids().map(|s| machine.state_path(s)).collect();
        let states = readable(paths.iter().map(|p| (p.replace('.', "_"), p.clone())).collect());
        let regions = machine.regions.iter().map(|(id, r)| {
            let path = machine.region_path(id);
            let kind = if r.parent.is_none() && r.name.is_none() { "chart" } else { "region" };
            (path.replace('.', "_"), format!("{kind} {path}"))
        });
        let regions = readable(regions.collect());
        let mut seen = BTreeMap::new();
        let transitions = machine.transitions.values().map(|t| {
            let n: &mut usize = seen.entry((t.source, t.target, t.internal)).or_default();
            *n += 1;
            let (source, target) = (&paths[t.source.index()], &paths[t.target.index()]);
            let last = &machine.states[t.target].name;
            let number = if *n > 1 { format!("_{n}") } else { String::new() };
            if t.internal {
                return (format!("{}_inside{number}", source.replace('.', "_")), format!("{source} inside#{n}"));
            }
            (format!("{}_to_{last}{number}", source.replace('.', "_")), format!("{source}->{target}#{n}"))
        });
        let transitions = readable(transitions.collect());
        Names { taken, states, regions, transitions }
    }

    /// A name for something about a state.
    pub fn state(&mut self, word: &str, state: StateId) -> String {
        let path = self.states[state.index()].clone();
        self.give(word, &path)
    }

    /// A name for something about a region.
    pub fn region(&mut self, word: &str, region: RegionId) -> String {
        let path = self.regions[region.index()].clone();
        self.give(word, &path)
    }

    /// A name for something about a transition.
    pub fn transition(&mut self, word: &str, transition: TransitionId) -> String {
        let path = self.transitions[transition.index()].clone();
        self.give(word, &path)
    }

    /// A name for something about a thing that has a unique name of its own.
    pub fn give(&mut self, word: &str, path: &str) -> String {
        self.fixed(&format!("{word}_{path}"))
    }

    /// `name`, or the nearest to it that is free and short enough.
    pub fn fixed(&mut self, name: &str) -> String {
        let name = &words::without_ends(name);
        let mut wanted = shorten(name);
        let mut attempt = 0;
        while words::clash(&wanted).is_some() || !self.taken.insert(iec::fold(&wanted)) {
            attempt += 1;
            wanted = hashed(name, &format!("{name}?{attempt}"));
        }
        wanted
    }
}

/// The readable forms, each made unique by a hash of its key where several read the same.
fn readable(forms: Vec<(String, String)>) -> Vec<String> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    for (form, _) in &forms {
        *count.entry(iec::fold(form)).or_default() += 1;
    }
    let unique = |(form, key): (String, String)| if count[&iec::fold(&form)] > 1 { hashed(&form, &key) } else { form };
    forms.into_iter().map(unique).collect()
}

fn shorten(name: &str) -> String {
    if name.len() <= limits::PLC_NAME_LENGTH { name.to_owned() } else { hashed(name, name) }
}

/// As much of `name` as fits, and a hash of `key`.
fn hashed(name: &str, key: &str) -> String {
    let room = limits::PLC_NAME_LENGTH - 9;
    let kept = name[..name.len().min(room)].trim_end_matches('_');
    format!("{kept}_{:08x}", fnv(key))
}

/// FNV-1a: the same on every machine and in every version.
fn fnv(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |h, b| (h ^ u32::from(b)).wrapping_mul(0x0100_0193))
}
