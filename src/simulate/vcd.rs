//! A recording to a value change dump, which GTKWave and Surfer show.
//!
//! Scopes: `inputs`, `hidden`, `outputs`, `variables`, `events`, `integers`, `alarms`, `filter`, then one for each chart that follows its
//! hierarchy. In the scope of a region `state` is the name of the active state, `-` while there is none, and
//! each state is one bit called by its name; what contains states is a scope of the same name.

use super::frame::{Frame, Layout, SCAN_WIDTH, WIDTH};
use super::record::{Recording, bare, columns};
use super::run::milliseconds;
use crate::ir::chart::{Machine, RegionId};
use crate::ir::scenario::Counted;
use std::collections::BTreeMap;
use std::ops::Range;
use vcd::{IdCode, SimulationCommand, TimescaleUnit, VarType, Writer};

/// Writes the recording as text. A scan stands at the time at which it begins, in milliseconds; one more
/// cycle is written behind the last scan, so that it can be seen. What happens between two scans is spread over the time between
/// them, which is in microseconds then.
pub fn write(machine: &Machine, recording: &Recording) -> String {
    let mut dump = Dump {
        machine,
        layout: Layout::of(machine),
        writer: Writer::new(Vec::new()),
        bits: Vec::new(),
        integers: Vec::new(),
        first_scan: None,
        regions: Vec::new(),
        fine: recording.moments().any(|(_, happens, _)| happens.is_some()),
    };
    dump.head();
    dump.body(recording);
    String::from_utf8(std::mem::take(dump.writer.writer())).expect("names and numbers are ASCII")
}

struct Dump<'m> {
    machine: &'m Machine,
    layout: Layout,
    writer: Writer<Vec<u8>>,
    /// The one-bit variables, by place in the frames.
    bits: Vec<(IdCode, usize)>,
    /// The variables that hold integers.
    integers: Vec<(IdCode, Counted)>,
    /// The variable that holds the number of the scan in which began what the filter notes.
    first_scan: Option<IdCode>,
    /// The variables that name the active state of a region.
    regions: Vec<(IdCode, RegionId)>,
    /// Whether times are in microseconds.
    fine: bool,
}

const MEMORY: &str = "writing to memory succeeds";

impl Dump<'_> {
    fn head(&mut self) {
        let (machine, layout) = (self.machine, self.layout);
        self.writer.comment("A run of a machine, by chartwright simulate").expect(MEMORY);
        self.writer.timescale(1, if self.fine { TimescaleUnit::US } else { TimescaleUnit::MS }).expect(MEMORY);
        self.writer.add_module(&machine.name).expect(MEMORY);
        let (inputs, outputs, alarms) = (layout.inputs(), layout.outputs(), layout.alarms());
        self.group("inputs", inputs.clone());
        self.group("hidden", inputs.end..layout.given().end);
        self.numbers("hidden", machine.plant.counts.ids().map(Counted::Hidden).collect());
        self.group("outputs", outputs.clone());
        self.group("variables", outputs.end..layout.events().start);
        self.group("events", layout.events());
        self.numbers("integers", machine.integers.ids().map(Counted::Program).collect());
        self.group("alarms", alarms);
        self.group("filter", layout.marks());
        if machine.safety.reset.is_some() {
            self.writer.add_module("filter").expect(MEMORY);
            let code = self.writer.add_var(VarType::Reg, SCAN_WIDTH as u32, "first_scan", None).expect(MEMORY);
            self.first_scan = Some(code);
            self.writer.upscope().expect(MEMORY);
        }
        for chart in &machine.charts {
            self.writer.add_module(&chart.name).expect(MEMORY);
            for &region in &chart.regions {
                self.region(region);
            }
            self.writer.upscope().expect(MEMORY);
        }
        self.writer.upscope().expect(MEMORY);
        self.writer.enddefinitions().expect(MEMORY);
    }

    fn group(&mut self, name: &str, places: Range<usize>) {
        if places.is_empty() {
            return;
        }
        let columns = columns(self.machine);
        self.writer.add_module(name).expect(MEMORY);
        for place in places {
            let name = bare(&columns[place]);
            let id = self.writer.add_wire(1, name).expect(MEMORY);
            self.bits.push((id, place));
        }
        self.writer.upscope().expect(MEMORY);
    }

    fn numbers(&mut self, name: &str, integers: Vec<Counted>) {
        if integers.is_empty() {
            return;
        }
        self.writer.add_module(name).expect(MEMORY);
        for integer in integers {
            let name = self.machine.counted(integer);
            let code = self.writer.add_var(VarType::Integer, WIDTH as u32, name, None).expect(MEMORY);
            self.integers.push((code, integer));
        }
        self.writer.upscope().expect(MEMORY);
    }

    /// Depth is bounded by the nesting limit of the source.
    fn region(&mut self, id: RegionId) {
        let machine = self.machine;
        let region = &machine.regions[id];
        if let Some(name) = &region.name {
            self.writer.add_module(name).expect(MEMORY);
        }
        let active = self.writer.add_var(VarType::String, 1, "state", None).expect(MEMORY);
        self.regions.push((active, id));
        for &state in &region.states {
            let bit = self.writer.add_wire(1, &machine.states[state].name).expect(MEMORY);
            self.bits.push((bit, self.layout.state(state)));
        }
        for &state in &region.states {
            let state = &machine.states[state];
            if state.regions.is_empty() {
                continue;
            }
            self.writer.add_module(&state.name).expect(MEMORY);
            for &inner in &state.regions {
                self.region(inner);
            }
            self.writer.upscope().expect(MEMORY);
        }
        if region.name.is_some() {
            self.writer.upscope().expect(MEMORY);
        }
    }

    fn body(&mut self, recording: &Recording) {
        let mut before: Option<&Frame> = None;
        let mut end = 0;
        let unit = if self.fine { 1000 } else { 1 };
        let mut inside: BTreeMap<u64, u64> = BTreeMap::new();
        recording
            .moments()
            .filter(|(_, happens, _)| happens.is_some())
            .for_each(|(s, ..)| *inside.entry(s).or_default() += 1);
        let mut number = 0;
        for (scan, happens, frame) in recording.moments() {
            number = if happens.is_some() { number + 1 } else { 0 };
            let changed = |place: usize| before.is_none_or(|b| b[place] != frame[place]);
            let cycle = u64::from(self.machine.cycle) * unit;
            // Nothing is before the first scan but what it finds.
            let part = if scan == 0 { 0 } else { cycle * number / (inside.get(&scan).copied().unwrap_or(0) + 1) };
            let time = milliseconds(self.machine, scan) * unit + part;
            if before.is_none() || before.is_some_and(|b| b != frame) {
                self.writer.timestamp(time).expect(MEMORY);
            }
            if before.is_none() {
                self.writer.begin(SimulationCommand::Dumpvars).expect(MEMORY);
            }
            for &(id, place) in self.bits.iter().filter(|(_, place)| changed(*place)) {
                self.writer.change_scalar(id, frame[place]).expect(MEMORY);
            }
            for &(code, id) in &self.integers {
                let value = self.layout.counted(id, frame);
                if before.is_none_or(|b| self.layout.counted(id, b) != value) {
                    let bits = (0..WIDTH).rev().map(|bit| vcd::Value::from(value >> bit & 1 == 1));
                    self.writer.change_vector(code, bits).expect(MEMORY);
                }
            }
            if let (Some(code), Some(number)) = (self.first_scan, self.layout.first_scan(frame))
                && before.is_none_or(|b| self.layout.first_scan(b) != Some(number))
            {
                let bits = (0..SCAN_WIDTH).rev().map(|bit| vcd::Value::from(number >> bit & 1 == 1));
                self.writer.change_vector(code, bits).expect(MEMORY);
            }
            for &(id, region) in &self.regions {
                let states = &self.machine.regions[region].states;
                if states.iter().any(|&s| changed(self.layout.state(s))) {
                    let active = states.iter().find(|&&s| frame[self.layout.state(s)]);
                    let name = active.map_or("-", |&s| self.machine.states[s].name.as_str());
                    self.writer.change_string(id, name).expect(MEMORY);
                }
            }
            if before.is_none() {
                self.writer.end().expect(MEMORY);
            }
            before = Some(frame);
            end = milliseconds(self.machine, scan) * unit + cycle;
        }
        self.writer.timestamp(end).expect(MEMORY);
    }
}
