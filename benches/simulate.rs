//! How many scans the simulators run in a second: INDEXA through the scripted cycle of its test, and
//! with inputs by chance.
//!
//! `cargo bench --bench simulate`. With `CHARTWRIGHT_RIVAL="COMMAND"` the emitted program is also handed to
//! `COMMAND FILE.xml`, which compiles and times it by other means (matiec and a C compiler, say), so that
//! both are measured in one run; what it prints follows.

use chartwright::ir::chart::Machine;
use chartwright::pipeline::{self, Dialect, Options};
use chartwright::read;
use chartwright::simulate::chart::Chart;
use chartwright::simulate::plc::Plc;
use divan::{Bencher, counter::ItemsCount};

/// How many scans are run and counted together.
const SCANS: usize = 10_000;

fn main() {
    divan::main();
    if let Ok(command) = std::env::var("CHARTWRIGHT_RIVAL") {
        rival(&command);
    }
}

/// Hands INDEXA's program to another runtime.
fn rival(command: &str) {
    let options = Options { dialect: Dialect::Beremiz, created: "1970-01-01T00:00:00".into(), prove: false };
    let output = pipeline::build(&repository("models/indexa.chart"), &options).0.expect("INDEXA has no errors");
    let path = std::env::temp_dir().join("chartwright-rival.xml");
    std::fs::write(&path, output.xml).expect("a temporary file can be written");
    let status = std::process::Command::new("sh").arg("-c").arg(format!("{command} {}", path.display())).status();
    println!("rival: {command}: {}", status.expect("there is a shell"));
}

fn repository(path: &str) -> String {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("the file is in the repository")
}

fn indexa() -> Machine {
    pipeline::check(&repository("models/indexa.chart")).0.expect("INDEXA has no errors")
}

/// The script's inputs scan by scan: a value holds from its scan on, an empty cell changes nothing.
fn scripted(machine: &Machine) -> Vec<Vec<bool>> {
    let script = repository("tests/fixtures/indexa_cycle.inputs.csv");
    let mut lines = script.lines().filter(|l| !l.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("there is a head").split(',').collect();
    let place = |name: &str| machine.inputs.values().position(|i| i.name == name);
    let places: Vec<Option<usize>> = head.iter().map(|name| place(name)).collect();
    let mut now = vec![false; machine.inputs.len()];
    let mut scans = Vec::new();
    for line in lines {
        let mut cells = line.split(',');
        let scan: usize = cells.next().and_then(|n| n.parse().ok()).expect("a scan's number");
        while scans.len() + 1 < scan {
            scans.push(now.clone());
        }
        for (cell, place) in cells.zip(&places[1..]) {
            match (cell, place) {
                ("", _) | (_, None) => {}
                (value, Some(at)) => now[*at] = value == "1",
            }
        }
        scans.push(now.clone());
    }
    scans
}

fn run(bencher: Bencher, machine: &Machine, inputs: &[Vec<bool>]) {
    let mut chart = Chart::new(machine);
    bencher.counter(ItemsCount::new(SCANS)).bench_local(|| {
        for now in inputs.iter().cycle().take(SCANS) {
            chart.scan(now);
        }
        chart.output(machine.outputs.ids().next().expect("INDEXA has outputs"))
    });
}

#[divan::bench]
fn indexa_cycle(bencher: Bencher) {
    let machine = indexa();
    run(bencher, &machine, &scripted(&machine));
}

#[divan::bench]
fn indexa_chance(bencher: Bencher) {
    let machine = indexa();
    let mut seed = 1u64;
    let inputs: Vec<Vec<bool>> = (0..1000)
        .map(|_| {
            let bit = |_| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                seed >> 63 == 1
            };
            machine.inputs.ids().map(bit).collect()
        })
        .collect();
    run(bencher, &machine, &inputs);
}

/// The same script on the PLC program, read back from XML.
#[divan::bench]
fn indexa_cycle_plc(bencher: Bencher) {
    let options = Options { dialect: Dialect::Beremiz, created: "1970-01-01T00:00:00".into(), prove: false };
    let output = pipeline::build(&repository("models/indexa.chart"), &options).0.expect("INDEXA has no errors");
    let project = read::read(&output.xml).0.expect("what is written can be read");
    let inputs = scripted(&output.machine);
    let names = output.machine.inputs.values();
    let ids: Vec<_> = names.map(|i| project.global(&i.name).expect("an input has a variable")).collect();
    let mut plc = Plc::new(&project);
    let mut now = 0;
    bencher.counter(ItemsCount::new(SCANS)).bench_local(|| {
        for values in inputs.iter().cycle().take(SCANS) {
            for (&id, &value) in ids.iter().zip(values) {
                plc.write(id, i64::from(value));
            }
            plc.scan(now);
            now += 10_000;
        }
    });
}
