//! The example machines, and what becomes of them where a part is left out or done in another way: what
//! the papers, or a model checker, say of it shows in a simulation, too. What a plant of any speed makes of
//! them is for `machines_verified`.

use crate::support::models::timed;
use crate::support::rng::Rng;
use chartwright::ir::chart::Machine;
use chartwright::ir::scenario::Given;
use chartwright::pipeline;
use chartwright::simulate::run::{Program, Run};

/// The text of a model in a plant that moves at a given speed, with some of it replaced, everywhere where it stands.
fn model(name: &str, changes: &[(&str, &str)]) -> String {
    let mut source = timed(name);
    for (from, to) in changes {
        assert!(source.contains(from), "{name} does not hold {from:?}");
        source = source.replace(from, to);
    }
    source
}

/// The machine of a text, without its scenarios.
fn machine(source: &str) -> Machine {
    let model = &source[..source.find("\nscenario ").expect("the model has scenarios")];
    let (machine, diagnostics) = pipeline::check(model);
    machine.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

/// A machine in its plant, asked by names.
struct Loop<'m> {
    machine: &'m Machine,
    run: Run<'m>,
}

impl<'m> Loop<'m> {
    fn new(machine: &'m Machine) -> Self {
        Loop { machine, run: Run::new(machine, Program::chart(machine)) }
    }

    fn given(&self, name: &str) -> Given {
        let inputs = self.machine.inputs.iter().map(|(id, i)| (&i.name, Given::Input(id)));
        let bits = self.machine.plant.bits.iter().map(|(id, b)| (&b.name, Given::Bit(id)));
        inputs.chain(bits).find(|(n, _)| *n == name).unwrap_or_else(|| panic!("there is no {name}")).1
    }

    fn set(&mut self, name: &str, value: bool) {
        let given = self.given(name);
        self.run.plant().set(given, value);
    }

    /// The place of an input, hidden bit or output in the values of a scan.
    fn place(&self, name: &str) -> usize {
        match self.machine.outputs.iter().find(|(_, o)| o.name == name) {
            Some((id, _)) => self.run.layout().output(id),
            None => self.run.layout().place(self.given(name)),
        }
    }
}

// ---- The four cylinders ---------------------------------------------------------------------------

/// What came of a run of the four cylinders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turned {
    /// Pallets reached the next place that many times.
    Moves(usize),
    /// A pallet was pushed against another one: HZ1.
    Pallets,
    /// A pallet was pushed against a rod: HZ2.
    Rod,
    /// A pallet was left between two places: HZ3.
    Left,
}

/// How long each rod takes for its way, and how long it hesitates before it sets out, in scans.
#[derive(Clone, Copy, Debug)]
struct Speeds {
    way: [u32; 4],
    start: [u32; 4],
}

/// A rod takes four scans for its way, as the reference has it, and sets out at once.
const LOCK_STEP: Speeds = Speeds { way: [4; 4], start: [0; 4] };

/// Speeds to try a machine with, the same each time.
fn speeds() -> Vec<Speeds> {
    let mut rng = Rng::new(4);
    let mut all = vec![LOCK_STEP, Speeds { way: [1; 4], start: [0; 4] }];
    for k in 0..4 {
        let (mut slow, mut idle) = (LOCK_STEP, LOCK_STEP);
        slow.way[k] = 40;
        idle.start[k] = 9;
        all.extend([slow, idle]);
    }
    all.extend((0..20).map(|i| Speeds {
        way: [0; 4].map(|_| *rng.pick(&[1, 2, 3, 4, 7, 20])),
        start: [0; 4].map(|_| if i % 2 == 0 { 0 } else { *rng.pick(&[1, 2, 9]) }),
    }));
    all
}

/// Turns that many pallets for that many scans.
fn turn(source: &str, speeds: Speeds, pallets: &[usize], scans: usize) -> Turned {
    let mut source = source.to_owned();
    for k in 1..=4 {
        let (way, start) = (speeds.way[k - 1], speeds.start[k - 1]);
        let travels = format!("Rod{k} travels 4 scans");
        assert!(source.contains(&travels));
        let mut told = format!("Rod{k} travels {way} scans");
        if start > 0 {
            told = format!(
                "hidden Air{k} Air{k} rises when O{k} after {start} scans Air{k} falls when not O{k} {told} when Air{k}"
            );
        }
        source = source.replace(&travels, &told);
    }
    let machine = machine(&source);
    let mut square = Loop::new(&machine);
    pallets.iter().for_each(|k| square.set(&format!("At{k}"), true));
    let places = |word: &str| (1..=4).map(|k| square.place(&format!("{word}{k}"))).collect::<Vec<_>>();
    let (at, way, order, back) = (places("At"), places("Way"), places("O"), places("B"));
    square.run.scan();
    square.set("Start", true);
    let mut moves = 0;
    for _ in 0..scans {
        let before: Vec<bool> = at.iter().map(|&p| square.run.frame()[p]).collect();
        square.run.scan();
        let now = square.run.frame();
        for k in 0..4 {
            let next = (k + 1) % 4;
            moves += usize::from(now[at[k]] && !before[k]);
            if now[way[k]] && now[at[next]] {
                return Turned::Pallets;
            }
            if now[way[k]] && !now[back[next]] {
                return Turned::Rod;
            }
            if now[way[k]] && !now[order[k]] {
                return Turned::Left;
            }
        }
    }
    Turned::Moves(moves)
}

const ARRANGEMENTS: [&[usize]; 5] = [&[1], &[1, 2], &[1, 3], &[2, 3, 4], &[1, 2, 4]];

/// The accidents of a machine with different speeds and pallets, each once.
fn accidents(source: &str) -> Vec<Turned> {
    let mut found = Vec::new();
    for speeds in speeds() {
        for pallets in ARRANGEMENTS {
            let turned = turn(source, speeds, pallets, 400);
            if !matches!(turned, Turned::Moves(_)) && !found.contains(&turned) {
                found.push(turned);
            }
        }
    }
    found
}

/// The model without the constraints whose names `drop` picks.
fn without(drop: impl Fn(&str) -> bool) -> String {
    let whole = model("four_cylinders", &[]);
    let kept = whole.lines().filter(|l| !l.split_once(": never").is_some_and(|(name, _)| drop(name.trim())));
    kept.map(|l| format!("{l}\n")).collect()
}

#[test]
fn pallets_turn_as_often_as_the_reference_says() {
    let source = model("four_cylinders", &[]);
    // Two neighbours take a move to get apart.
    for (pallets, moves) in [(&[1][..], 200), (&[1, 3], 400), (&[1, 2], 399), (&[1, 2, 3], 200), (&[1, 2, 3, 4], 0)] {
        assert_eq!(turn(&source, LOCK_STEP, pallets, 2000), Turned::Moves(moves), "{pallets:?}");
    }
}

#[test]
fn at_any_speed_pallets_turn_without_accident() {
    let source = model("four_cylinders", &[]);
    for speeds in speeds() {
        for pallets in ARRANGEMENTS {
            let turned = turn(&source, speeds, pallets, 600);
            assert!(matches!(turned, Turned::Moves(2..)), "{speeds:?} {pallets:?}: {turned:?}");
        }
    }
}

#[test]
fn every_family_of_constraints_but_the_first_is_needed() {
    for (family, accident) in
        [(2, Turned::Pallets), (3, Turned::Rod), (4, Turned::Rod), (5, Turned::Rod), (0, Turned::Left)]
    {
        let number = |name: &str| name.strip_prefix("CS").and_then(|n| n.parse::<usize>().ok());
        let found = accidents(&without(|name| number(name).is_some_and(|n| n % 6 == family)));
        assert!(found.contains(&accident), "without CS{family}: {found:?}");
    }
    assert!(accidents(&without(|name| name.starts_with("CC"))).contains(&Turned::Rod));
    assert_eq!(accidents(&without(|name| name.starts_with("CS") && name[2..].parse::<usize>().unwrap() % 6 == 1)), []);
}

/// The model with a change for each cylinder: `{k}` in the texts is its number, `{n}` that of the next one.
fn varied(changes: &[(&str, &str)]) -> String {
    let mut source = model("four_cylinders", &[]);
    for k in 1..=4 {
        for (from, to) in changes {
            let named = |text: &str| text.replace("{k}", &k.to_string()).replace("{n}", &(k % 4 + 1).to_string());
            let (from, to) = (named(from), named(to));
            assert!(source.contains(&from), "the model does not hold {from:?}");
            source = source.replace(&from, &to);
        }
    }
    source
}

const SET: &str = "after filter { from Free{k} to Carried{k} when rise(O{k}) and I{k} }";
const RESET: &str = "from Carried{k} to Free{k} when H{k}";

#[test]
fn an_observer_that_is_set_one_scan_late_misses_pallets() {
    // In front of the filter, with the sensor of now and the order of the last scan.
    let late = varied(&[(SET, "from Free{k} to Carried{k} when I{k} and prev(O{k})")]);
    assert!(accidents(&late).contains(&Turned::Rod), "{:?}", accidents(&late));
}

#[test]
fn an_observer_that_is_reset_by_the_next_sensor_needs_one_that_is_exact() {
    let next = (RESET, "from Carried{k} to Free{k} when I{n}");
    assert_eq!(accidents(&varied(&[next])), []);
    // A sensor that sees the pallet as soon as it is on its way.
    let early = "I{n} rises when At{n} or Way{k}  I{n} falls when not At{n} and not Way{k}";
    let seen = "I{n} follows At{n}";
    assert!(accidents(&varied(&[next, (seen, early)])).contains(&Turned::Rod));
    assert_eq!(accidents(&varied(&[(seen, early)])), []);
}

#[test]
fn an_observer_of_one_step_a_scan_blocks_a_fast_machine() {
    // The edge of the last scan, taken in before the filter; a fast rod is back before it is reset.
    let slow = varied(&[(SET, "from Free{k} to Carried{k} when prev(O{k}) and prev(B{k}) and prev(I{k})")]);
    assert_eq!(accidents(&slow), []);
    let fast = Speeds { way: [1; 4], start: [0; 4] };
    for pallets in [&[1, 2][..], &[1, 2, 3]] {
        let Turned::Moves(after) = turn(&slow, fast, pallets, 400) else { panic!("an accident") };
        assert_eq!(turn(&slow, fast, pallets, 4000), Turned::Moves(after), "it goes on moving");
        assert!(matches!(turn(&model("four_cylinders", &[]), fast, pallets, 4000), Turned::Moves(1000..)));
    }
}

#[test]
fn other_reliefs_get_stuck() {
    const COMBINED: &str = "never rise(O{k}) and rise(O{n}) and I{k} yields O{n}";
    // All four constraints act at once and all orders are taken back, for ever.
    let always = varied(&[(COMBINED, "never rise(O{k}) and rise(O{n}) yields O{n}")]);
    assert_eq!(turn(&always, LOCK_STEP, &[1], 2000), Turned::Moves(0));
    let first = varied(&[(COMBINED, "never rise(O{k}) and rise(O{n}) yields O{k}")]);
    assert_eq!(turn(&first, LOCK_STEP, &[1], 2000), Turned::Moves(0));
    let pushing = varied(&[(COMBINED, "never rise(O{k}) and rise(O{n}) and I{k} yields O{k}")]);
    assert_eq!(turn(&pushing, LOCK_STEP, &[1], 2000), Turned::Moves(0));
    for other in [always, first, pushing] {
        assert_eq!(accidents(&other), []);
    }
}

// ---- The two carts --------------------------------------------------------------------------------

/// Whether the carts collide when both are stopped and slip at random.
fn collide(source: &str, seeds: std::ops::Range<u64>) -> bool {
    let machine = machine(source);
    seeds.into_iter().any(|seed| {
        let mut carts = Loop::new(&machine);
        let mut rng = Rng::new(seed);
        let zone: Vec<Vec<usize>> =
            [["P14", "P15"], ["P24", "P25"]].iter().map(|z| z.iter().map(|p| carts.place(p)).collect()).collect();
        let percent = [rng.below(60), rng.below(60)];
        (0..2000).any(|_| {
            for n in 1..=2 {
                let slips = rng.chance(percent[n - 1]);
                carts.set(&format!("Slip{n}"), slips);
                if rng.chance(12) {
                    let stops = rng.chance(50);
                    carts.set(&format!("Halt{n}"), stops);
                }
            }
            carts.run.scan();
            let frame = carts.run.frame();
            zone.iter().all(|places| places.iter().any(|&p| frame[p]))
        })
    })
}

/// The carts without the constraints whose names begin so.
fn carts_without(drop: &[&str]) -> String {
    let whole = model("carts", &[]);
    let dropped = |l: &str| l.contains(": never") && drop.iter().any(|name| l.trim().starts_with(name));
    whole.lines().filter(|l| !dropped(l)).map(|l| format!("{l}\n")).collect()
}

#[test]
fn the_carts_do_not_collide() {
    assert!(!collide(&model("carts", &[]), 0..40));
}

/// The vertical cart's observer as it is printed: it leaves the zone by falling edges.
const PRINTED: [(&str, &str); 2] =
    [("rise(UpperBorder)", "fall(UpperBorder)"), ("rise(LowerBorder)", "fall(LowerBorder)")];

#[test]
fn the_carts_as_printed_collide() {
    // The rule that the paper has, "not both inside", names no output; so there is nothing that stops a
    // cart.
    let mut printed = carts_without(&["Z", "Q", "C", "REV"]);
    for (from, to) in PRINTED {
        printed = printed.replace(from, to);
    }
    assert!(collide(&printed, 0..5));
    // With all guards its falling edges are no danger: a cart that has just left the zone counts as inside
    // until it has left the border, too.
    assert!(!collide(&model("carts", &PRINTED), 0..40));
}

#[test]
fn an_observer_that_forgets_an_order_too_soon_misses_a_cart() {
    let forgetful = model(
        "carts",
        &[(" or in(WasLeft)", ""), (" or in(WasRight)", ""), (" or in(WasUp)", ""), (" or in(WasDown)", "")],
    );
    assert!(collide(&forgetful, 0..40));
}

#[test]
fn each_guard_of_the_zone_is_needed() {
    for name in ["Z1", "Z2", "Z3", "Z4", "Q1", "Q2", "Q3", "Q4", "C1", "C2", "C3", "C4"] {
        assert!(collide(&carts_without(&[name]), 0..60), "without {name}");
    }
    assert!(!collide(&carts_without(&["SSC", "E", "REV"]), 0..40));
}
