//! Models built, written, read back and proved, and runs of a proof's two sides on the simulators.

use super::rng::Rng;
use chartwright::ir::chart::Machine;
use chartwright::ir::iec;
use chartwright::pipeline::{self, Dialect, Options, Output};
use chartwright::prove::joint::Stimulus;
use chartwright::prove::parts::Part;
use chartwright::prove::trace::Trace;
use chartwright::prove::{Correspondence, Verdict, equivalence};
use chartwright::read;
use chartwright::simulate::chart::Chart;
use chartwright::simulate::plc::Plc;

/// Builds a model, or says what is wrong with it.
pub fn build(source: &str, dialect: Dialect) -> Result<Output, String> {
    let options = Options { dialect, created: "1970-01-01T00:00:00".to_owned(), prove: false };
    let (output, diagnostics) = pipeline::build(source, &options);
    output.ok_or_else(|| diagnostics.iter().map(|d| format!("{} {}\n", d.code.number(), d.message)).collect())
}

/// The program that a reader finds in what the compiler writes.
pub fn read_back(output: &Output) -> iec::Project {
    let (program, diagnostics) = read::read(&output.xml);
    program.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// What the proof says of a model's own program.
pub fn verdict(output: &Output) -> Verdict {
    equivalence(&output.machine, &Correspondence::of(&output.machine, &output.project), &read_back(output))
}

/// Chart and program on the simulators, which share nothing with the proof but the meaning.
pub struct Simulated<'a> {
    machine: &'a Machine,
    names: &'a Correspondence,
    program: &'a iec::Project,
    chart: Chart,
    plc: Plc,
    now: iec::Time,
}

impl<'a> Simulated<'a> {
    pub fn new(machine: &'a Machine, names: &'a Correspondence, program: &'a iec::Project) -> Self {
        Simulated { machine, names, program, chart: Chart::new(machine), plc: Plc::new(program), now: 0 }
    }

    /// One scan of both. The chart's simulator knows no other pause than the cycle time.
    pub fn scan(&mut self, stimulus: &Stimulus) {
        if self.plc.scans() > 0 {
            self.now += stimulus.pause;
        }
        self.chart.scan(&stimulus.inputs);
        for (name, &value) in self.names.inputs.iter().zip(&stimulus.inputs) {
            self.plc.write(self.program.global(name).expect("inputs are globals"), i64::from(value));
        }
        self.plc.scan(self.now);
    }

    /// The value of a part in the chart, if its simulator shows it.
    pub fn chart(&self, part: Part) -> Option<bool> {
        Some(match part {
            Part::Flag(s) | Part::Step(s) => self.chart.is_active(s),
            Part::Output(o) => self.chart.output(o),
            Part::Variable(v) => self.chart.variable(v),
            Part::Event(e) => self.chart.event(e),
            Part::Bit(i, bit) => self.chart.integer(i) >> bit & 1 == 1,
            Part::Scan(number, bit) => self.chart.scan_number(number) >> bit & 1 == 1,
            Part::Command(o) => self.chart.command(o),
            Part::Acted(c) => self.chart.acted(c),
            Part::Broken(a) => self.chart.broken(a),
            Part::Mark(mark, _) => self.chart.mark(mark),
            Part::Input(i) => self.chart.input(i),
            Part::Raised(_) | Part::Begins(_) => return None,
        })
    }

    /// The value of a part in the program, if its simulator shows it.
    pub fn program(&self, part: Part) -> Option<bool> {
        let name = match part {
            Part::Step(s) => {
                let (kind, step) = self.names.steps[s.index()].as_ref()?;
                let (p, program) = self.program.programs.iter().enumerate().find(|(_, p)| p.kind == *kind)?;
                let iec::Body::Sfc(sfc) = &program.body else { return None };
                let id = sfc.steps.iter().find(|(_, s)| s.name == *step)?.0;
                return Some(self.plc.is_active(p, id));
            }
            Part::Flag(s) => Some(&self.names.flags[s.index()]),
            Part::Output(o) => Some(&self.names.outputs[o.index()]),
            Part::Variable(v) => Some(&self.names.variables[v.index()]),
            Part::Event(e) => Some(&self.names.events[e.index()]),
            Part::Raised(e) => self.names.raised[e.index()].as_ref(),
            Part::Command(o) => self.names.commands[o.index()].as_ref(),
            Part::Acted(c) => self.names.acted[c.index()].as_ref(),
            Part::Broken(a) => self.names.broken[a].as_ref(),
            Part::Mark(_, i) => self.names.marks[i].as_ref(),
            Part::Input(i) => Some(&self.names.inputs[i.index()]),
            Part::Bit(i, bit) => {
                let id = self.program.global(&self.names.integers[i.index()])?;
                return Some(self.plc.read(id) >> bit & 1 == 1);
            }
            Part::Scan(number, bit) => {
                let id = self.program.global(self.names.scans[number as usize].as_ref()?)?;
                return Some(self.plc.read(id) >> bit & 1 == 1);
            }
            Part::Begins(_) => None,
        };
        Some(self.plc.read(self.program.global(name?)?) == 1)
    }

    /// What is said of a part, for messages.
    pub fn describe(&self, part: Part) -> String {
        part.describe(self.machine)
    }
}

/// The simulators see in each scan what the trace says.
pub fn confirm(machine: &Machine, names: &Correspondence, project: &iec::Project, trace: &Trace, what: &str) {
    assert!(!trace.differences().is_empty(), "{what}:\n{trace}");
    let mut simulated = Simulated::new(machine, names, project);
    let on_time = trace.scans.iter().skip(1).all(|s| s.stimulus.pause == trace.cycle);
    for (n, scan) in trace.scans.iter().enumerate() {
        simulated.scan(&scan.stimulus);
        for (i, compared) in trace.compared.iter().enumerate() {
            let chart = simulated.chart(compared.part).filter(|_| on_time);
            assert!(chart.is_none_or(|v| v == scan.chart[i]), "{what}: {} in scan {n}\n{trace}", compared.what);
            let program = simulated.program(compared.part);
            assert!(program.is_none_or(|v| v == scan.program[i]), "{what}: {} in scan {n}\n{trace}", compared.name);
        }
    }
}

/// The simulators see no difference in random runs: in no state, command, output, alarm or variable.
pub fn agree_by_chance(machine: &Machine, names: &Correspondence, project: &iec::Project, what: &str, seed: u64) {
    let mut rng = Rng::new(seed);
    let outputs = machine.outputs.ids().flat_map(|o| [Part::Output(o), Part::Command(o)]);
    let acted = machine.safety.constraints.ids().map(Part::Acted);
    let broken = (0..names.broken.len()).map(Part::Broken);
    let variables = machine.variables.ids().map(Part::Variable).chain(machine.events.ids().map(Part::Event));
    let compared: Vec<Part> =
        machine.states.ids().map(Part::Flag).chain(outputs).chain(acted).chain(broken).chain(variables).collect();
    for percent in [2, 10, 40] {
        let mut simulated = Simulated::new(machine, names, project);
        let mut inputs: Vec<bool> = machine.inputs.ids().map(|_| rng.chance(50)).collect();
        for scan in 0..300 {
            inputs.iter_mut().for_each(|value| *value ^= rng.chance(percent));
            let pause = i64::from(machine.cycle) * 1000;
            simulated.scan(&Stimulus { pause, inputs: inputs.clone() });
            for &part in &compared {
                // What a program keeps nowhere shows nowhere.
                let Some((chart, program)) = simulated.chart(part).zip(simulated.program(part)) else { continue };
                assert_eq!(chart, program, "{what}: {} in scan {scan}", simulated.describe(part));
            }
        }
    }
}
