//! What a scan does, rule by rule.

use super::Plc;
use crate::base::Id;
use crate::ir::expr::Expr;
use crate::ir::iec::{
    Action, Association, Atom, Block, BlockId, BlockKind, Body, Bool, Call, Coil, CoilKind, Condition, Kind, Number,
    Program, Project, Qualifier, Relation, Scope, Sfc, Statement, Step, StepId, Target, Task, Time, Transition, VarId,
    Variable,
};

/// A project with the BOOL variables `a`, `b`, `c` and so on.
fn project(variables: usize) -> Project {
    let mut project = Project::default();
    for index in 0..variables {
        declare(&mut project, &char::from(b'a' + index as u8).to_string(), Kind::Bool);
    }
    project
}

fn declare(project: &mut Project, name: &str, kind: Kind) -> VarId {
    project.variables.push(Variable { name: name.to_owned(), scope: Scope::Global, kind, initial: 0, address: None })
}

fn block(project: &mut Project, kind: BlockKind) -> BlockId {
    project.blocks.push(Block { name: String::new(), scope: Scope::Global, kind })
}

fn run_body(project: &mut Project, body: Body) {
    let name = format!("P{}", project.programs.len());
    project.programs.push(Program { kind: name.clone(), name, task: None, body });
}

fn var(name: char) -> VarId {
    Id::from_index((name as u8 - b'a') as usize)
}

fn is(name: char) -> Bool {
    Expr::Atom(Atom::Variable(var(name)))
}

fn coil(name: char, value: Bool) -> Statement {
    Statement::Coil(Coil { condition: Condition::simple(value), variable: var(name), kind: CoilKind::Plain })
}

fn call(block: BlockId, input: Bool) -> Call {
    Call { block, input: Some(Condition::simple(input)), reset: None, preset: None }
}

fn step(name: char, qualifier: Qualifier, duration: Time) -> Association {
    Association { target: Target::Variable(var(name)), qualifier, duration: duration * 1000 }
}

/// A chart of steps with these associations, of which the first is initial.
fn chart(steps: Vec<Vec<Association>>) -> Sfc {
    let mut sfc = Sfc::default();
    for (index, associations) in steps.into_iter().enumerate() {
        sfc.steps.push(Step { name: format!("S{index}"), initial: index == 0, associations });
    }
    sfc
}

fn go(sfc: &mut Sfc, from: &[usize], to: &[usize], priority: Option<u32>, condition: Bool) {
    let ids = |list: &[usize]| -> Vec<StepId> { list.iter().map(|&i| Id::from_index(i)).collect() };
    let condition = Condition::simple(condition);
    sfc.transitions.push(Transition { from: ids(from), to: ids(to), priority, condition });
}

/// Runs scans 10 ms apart. Each word of `inputs` is a scan: the variables that become TRUE in lower
/// case and those that become FALSE in upper case, or `.`; the words of the result are the values
/// of `seen` after each scan.
fn play(project: &Project, inputs: &str, seen: &str) -> String {
    let mut plc = Plc::new(project);
    let mut words = Vec::new();
    for (scan, word) in inputs.split_whitespace().enumerate() {
        for letter in word.chars().filter(|c| c.is_ascii_alphabetic()) {
            plc.write(var(letter.to_ascii_lowercase()), i64::from(letter.is_ascii_lowercase()));
        }
        plc.scan(scan as Time * 10_000);
        words.push(seen.chars().map(|c| plc.read(var(c)).to_string()).collect::<String>());
    }
    words.join(" ")
}

/// A chart over `a`, `b`, …, played.
fn play_chart(variables: usize, sfc: Sfc, inputs: &str, seen: &str) -> String {
    let mut project = project(variables);
    run_body(&mut project, Body::Sfc(sfc));
    play(&project, inputs, seen)
}

/// The outputs Q of a block with input `a` and reset `b`, played.
fn play_block(kind: BlockKind, preset: Option<Time>, inputs: &str) -> String {
    let mut project = project(4);
    let id = block(&mut project, kind);
    let reset = matches!(kind, BlockKind::Sr | BlockKind::Rs).then(|| Condition::simple(is('b')));
    let preset = preset.map(|p| Number::Const(p * 1000));
    let running = Atom::Compare(Relation::Greater, Number::Elapsed(id), Number::Const(0));
    run_body(
        &mut project,
        Body::Code(vec![
            Statement::Call(Call { reset, preset, ..call(id, is('a')) }),
            coil('c', Expr::Atom(Atom::Output(id))),
            coil('d', Expr::Atom(running)),
        ]),
    );
    play(&project, inputs, if preset_is_used(kind) { "cd" } else { "c" })
}

fn preset_is_used(kind: BlockKind) -> bool {
    matches!(kind, BlockKind::Ton | BlockKind::Tof | BlockKind::Tp)
}

#[test]
fn triggers_fire_in_the_first_scan_already() {
    assert_eq!(play_block(BlockKind::RTrig, None, "a . A a"), "1 0 0 1");
    assert_eq!(play_block(BlockKind::FTrig, None, ". . a A"), "1 0 0 1");
}

#[test]
fn bistables_differ_when_both_inputs_are_true() {
    assert_eq!(play_block(BlockKind::Sr, None, "ab A . Ba A b"), "1 0 0 1 1 0");
    assert_eq!(play_block(BlockKind::Rs, None, "ab A . Ba A b"), "0 0 0 1 1 0");
}

#[test]
fn timers_end_in_the_first_scan_at_or_after_their_time() {
    assert_eq!(play_block(BlockKind::Ton, Some(20), "a . . . A a . A ."), "00 01 11 11 00 00 01 00 00");
    assert_eq!(play_block(BlockKind::Ton, Some(25), "a . . . A"), "00 01 01 11 00");
    assert_eq!(play_block(BlockKind::Tof, Some(20), ". a A . . . a A a"), "00 10 10 11 01 01 10 10 10");
    assert_eq!(play_block(BlockKind::Tp, Some(20), "a A a . . A a"), "10 11 01 01 01 00 10");
    assert_eq!(play_block(BlockKind::Ton, Some(0), "a . A"), "00 10 00");
}

#[test]
fn a_transition_fires_before_actions_and_one_a_scan() {
    let n = |v| vec![step(v, Qualifier::NonStored, 0)];
    let mut sfc = chart(vec![n('b'), n('c'), n('d')]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[2], None, Expr::TRUE);
    assert_eq!(play_chart(4, sfc.clone(), ". a A", "bcd"), "100 010 001");
    // Left in the first scan, the initial step has done nothing.
    assert_eq!(play_chart(4, sfc, "a .", "bcd"), "010 001");
}

#[test]
fn priorities_exclude_and_their_absence_does_not() {
    let n = |v| vec![step(v, Qualifier::NonStored, 0)];
    let with = |first, second| {
        let mut sfc = chart(vec![vec![], n('c'), n('d')]);
        go(&mut sfc, &[0], &[1], first, is('a'));
        go(&mut sfc, &[0], &[2], second, is('b'));
        play_chart(4, sfc, ". ab", "cd")
    };
    assert_eq!(with(Some(1), Some(2)), "00 10");
    assert_eq!(with(Some(2), Some(1)), "00 01");
    assert_eq!(with(None, None), "00 11");
    assert_eq!(with(None, Some(1)), "00 11", "one without priority is tested first and clears late");
    assert_eq!(with(Some(1), None), "00 10", "one without priority is tested last, though it counts as 0");
}

#[test]
fn a_variable_of_two_steps_drops_when_going_back() {
    let n = || vec![step('b', Qualifier::NonStored, 0)];
    let mut sfc = chart(vec![n(), n()]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[0], None, is('a').not());
    assert_eq!(play_chart(2, sfc, ". a . A . a A .", "b"), "1 1 1 0 1 1 0 1");
}

#[test]
fn pulses_write_false_in_all_other_scans() {
    let mut sfc = chart(vec![
        vec![step('b', Qualifier::Pulse, 0), step('c', Qualifier::PulseFalling, 0)],
        vec![step('d', Qualifier::PulseRising, 0)],
    ]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[0], None, is('a').not());
    // The initial step's pulse does not come at the start. What else writes `b` is overwritten.
    assert_eq!(play_chart(4, sfc, ". a . bA . .", "bcd"), "000 011 000 100 000 000");
}

#[test]
fn of_two_pulses_on_one_variable_the_last_wins() {
    let p = || vec![step('b', Qualifier::Pulse, 0)];
    let mut sfc = chart(vec![vec![], p(), p()]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[2], None, is('a').not());
    assert_eq!(play_chart(2, sfc, ". a . A .", "b"), "0 0 0 1 0");
}

#[test]
fn set_stays_and_reset_wins() {
    let mut sfc = chart(vec![
        vec![],
        vec![step('b', Qualifier::Set, 0)],
        vec![step('b', Qualifier::NonStored, 0), step('b', Qualifier::Reset, 0)],
    ]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[0], None, is('a').not());
    go(&mut sfc, &[0], &[2], None, is('c'));
    go(&mut sfc, &[2], &[0], None, is('c').not());
    assert_eq!(play_chart(3, sfc, ". a A . B . c C", "b"), "0 1 1 1 0 0 0 0");
}

#[test]
fn limited_and_delayed_actions_watch_the_step_s_time() {
    let mut sfc = chart(vec![vec![], vec![step('b', Qualifier::Limited, 20), step('c', Qualifier::Delayed, 20)]]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[0], None, is('a').not());
    assert_eq!(play_chart(3, sfc, ". a . . . A a A", "bc"), "00 10 10 01 01 00 10 00");
}

#[test]
fn stored_and_delayed_actions_outlive_their_step() {
    let mut sfc = chart(vec![
        vec![],
        vec![
            step('b', Qualifier::StoredLimited, 30),
            step('c', Qualifier::StoredDelayed, 20),
            step('d', Qualifier::DelayedStored, 20),
        ],
    ]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[0], None, is('a').not());
    assert_eq!(play_chart(4, sfc.clone(), ". a A . . . .", "bcd"), "000 100 100 110 010 010 010");
    assert_eq!(play_chart(4, sfc, ". a . . . .", "bcd"), "000 100 100 111 011 011");
}

#[test]
fn a_step_that_is_left_and_entered_at_once_shows_no_edge() {
    let mut sfc = chart(vec![vec![], vec![step('b', Qualifier::Pulse, 0), step('c', Qualifier::Limited, 20)]]);
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[1], None, is('d'));
    // Its time begins anew.
    assert_eq!(play_chart(4, sfc, ". a . . d D . .", "bc"), "00 11 01 00 01 01 00 00");
}

#[test]
fn parallel_branches_begin_together_and_wait_for_each_other() {
    let n = |v| vec![step(v, Qualifier::NonStored, 0)];
    let mut sfc = chart(vec![vec![], n('c'), n('d'), n('e'), n('f')]);
    go(&mut sfc, &[0], &[1, 2], None, is('a'));
    go(&mut sfc, &[2], &[3], None, is('b'));
    go(&mut sfc, &[1, 3], &[4], None, Expr::TRUE);
    assert_eq!(play_chart(6, sfc, ". a . b . .", "cdef"), "0000 1100 1100 1010 0001 0001");
}

#[test]
fn conditions_see_steps_left_before_by_priority() {
    let flag = |s: usize| Expr::Atom(Atom::Step(Id::from_index(s)));
    let n = |v| vec![step(v, Qualifier::NonStored, 0)];
    let mut sfc = chart(vec![vec![], vec![], n('b'), n('c')]);
    sfc.steps[Id::from_index(1)].initial = true;
    go(&mut sfc, &[0], &[2], Some(1), is('a'));
    go(&mut sfc, &[1], &[3], Some(2), flag(0));
    // Both are tested in one scan: step 0 is left when the second one looks.
    assert_eq!(play_chart(3, sfc.clone(), "a .", "bc"), "10 10");
    sfc.transitions[0].priority = None;
    sfc.transitions.swap(0, 1);
    assert_eq!(play_chart(3, sfc, "a .", "bc"), "11 11");
}

#[test]
fn the_body_of_an_action_does_not_run_once_more() {
    let mut project = project(1);
    let count = declare(&mut project, "n", Kind::Int { bits: 8, signed: true });
    let stored = declare(&mut project, "m", Kind::Int { bits: 8, signed: false });
    let plus = |to, by| Statement::Move {
        to,
        value: Number::Sum(Box::new(Number::Variable(to)), Box::new(Number::Const(by))),
    };
    let act = |action: usize, qualifier| Association {
        target: Target::Action(Id::from_index(action)),
        qualifier,
        duration: 0,
    };
    let mut sfc =
        chart(vec![vec![act(1, Qualifier::Reset)], vec![act(0, Qualifier::NonStored), act(1, Qualifier::Set)]]);
    sfc.actions.push(Action { name: "A".to_owned(), body: vec![plus(count, 100)] });
    sfc.actions.push(Action { name: "B".to_owned(), body: vec![plus(stored, 100)] });
    go(&mut sfc, &[0], &[1], None, is('a'));
    go(&mut sfc, &[1], &[0], None, is('a').not());
    run_body(&mut project, Body::Sfc(sfc));
    let mut plc = Plc::new(&project);
    let mut seen = Vec::new();
    for (scan, input) in [0, 1, 1, 0, 1].into_iter().enumerate() {
        plc.write(var('a'), input);
        plc.scan(scan as Time * 10_000);
        seen.push((plc.read(count), plc.read(stored)));
    }
    assert_eq!(seen, [(0, 0), (100, 100), (-56, 200), (-56, 200), (44, 44)]);
    assert!(plc.is_active(0, Id::from_index(1)));
    plc.scan(70_000);
    assert_eq!(plc.step_time(0, Id::from_index(1)), 30_000);
}

#[test]
fn slower_tasks_run_in_multiples_of_the_tick() {
    let mut project = project(3);
    let task = |project: &mut Project, interval| project.tasks.push(Task { name: String::new(), interval });
    let (fast, slow) = (task(&mut project, 10_000), task(&mut project, 20_000));
    run_body(&mut project, Body::Code(vec![coil('b', is('a'))]));
    run_body(&mut project, Body::Code(vec![coil('c', is('b'))]));
    project.programs[0].task = Some(slow);
    project.programs[1].task = Some(fast);
    assert_eq!(project.tick(), Some(10_000));
    assert_eq!(play(&project, "a . A . .", "bc"), "00 11 11 00 00");
    project.programs.swap(0, 1);
    assert_eq!(play(&project, "a . . A . .", "bc"), "00 10 11 01 00 00");
}

#[test]
fn conditions_of_all_forms_are_what_they_say() {
    let mut project = project(7);
    let less = Atom::Compare(
        Relation::Less,
        Number::Difference(Box::new(Number::Const(1)), Box::new(Number::Negative(Box::new(Number::Const(-2))))),
        Number::Const(0),
    );
    let nested = Expr::xor(is('a'), Expr::xor(is('b'), Expr::xor(is('c'), Expr::any([is('a'), is('b')]))));
    let shared = Condition {
        shared: vec![Expr::any([is('a'), is('b')]), Expr::all([Expr::Atom(Atom::Shared(0)), is('c')])],
        value: Expr::any([Expr::Atom(Atom::Shared(1)), Expr::Atom(Atom::Shared(0)).not()]),
    };
    run_body(
        &mut project,
        Body::Code(vec![
            coil('d', nested.clone()),
            Statement::Coil(Coil { condition: shared, variable: var('e'), kind: CoilKind::Plain }),
            coil('f', Expr::all([is('a'), Expr::Atom(less)])),
            coil('g', Expr::Const(true)),
        ]),
    );
    for number in 0..8 {
        let (a, b, c) = (number & 1 != 0, number & 2 != 0, number & 4 != 0);
        let mut plc = Plc::new(&project);
        for (name, value) in [('a', a), ('b', b), ('c', c)] {
            plc.write(var(name), i64::from(value));
        }
        plc.scan(0);
        let seen = ['d', 'e', 'f', 'g'].map(|v| plc.read(var(v)) == 1);
        let either = a || b;
        assert_eq!(seen, [a ^ b ^ c ^ either, !either || c, a, true], "{number}");
    }
}
