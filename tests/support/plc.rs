//! PLC projects, built by hand.

use chartwright::ir::expr::Expr;
use chartwright::ir::ladder::{CoilKind, Ladder, Rung};
use chartwright::ir::plc::{Body, Global, GlobalId, Origin, Program, Project, Role, Task, Value};
use chartwright::ir::sfc::{Sfc, Step, StepId, Transition};
use chartwright::ir::sop::Sum;

/// An empty project.
pub fn project(name: &str) -> Project {
    Project {
        name: name.to_owned(),
        description: format!("{name}, built by hand"),
        globals: Default::default(),
        programs: Vec::new(),
        task: Task {
            name: "MainTask".to_owned(),
            configuration: "Config".to_owned(),
            resource: "Res".to_owned(),
            interval: 10,
        },
        notes: Vec::new(),
    }
}

/// Adds a global.
pub fn global(project: &mut Project, name: &str, role: Role, address: Option<&str>) -> GlobalId {
    project.globals.push(Global {
        name: name.to_owned(),
        address: address.map(str::to_owned),
        initial: Value::Bool(false),
        role,
        description: format!("what {name} means"),
        origin: Origin::default(),
    })
}

/// `g`.
pub fn on(g: GlobalId) -> Expr<GlobalId> {
    Expr::Atom(g)
}

/// `not g`.
pub fn off(g: GlobalId) -> Expr<GlobalId> {
    Expr::Atom(g).not()
}

/// All of `parts`.
pub fn all<const N: usize>(parts: [Expr<GlobalId>; N]) -> Expr<GlobalId> {
    Expr::all(parts)
}

/// One of `parts`.
pub fn any<const N: usize>(parts: [Expr<GlobalId>; N]) -> Expr<GlobalId> {
    Expr::any(parts)
}

/// Adds a step named `S_name`.
pub fn step(sfc: &mut Sfc, name: &str, flag: Option<GlobalId>) -> StepId {
    sfc.steps.push(Step {
        name: format!("S_{name}"),
        flag,
        description: format!("step {name}"),
        origin: Origin::default(),
    })
}

/// Adds a transition after those that leave the same step.
pub fn transition(sfc: &mut Sfc, from: StepId, to: StepId, condition: Expr<GlobalId>) {
    let priority = 1 + sfc.transitions.iter().filter(|t| t.from == from).count() as u32;
    sfc.transitions.push(Transition {
        from,
        to,
        priority,
        condition,
        description: String::new(),
        origin: Origin::default(),
    });
}

/// Adds a rung.
pub fn rung(ladder: &mut Ladder, condition: &Expr<GlobalId>, coil: GlobalId, kind: CoilKind) {
    ladder.rungs.push(Rung {
        comment: format!("rung {}", ladder.rungs.len()),
        condition: Sum::of(condition, 1000).expect("a small condition"),
        timer: None,
        function: None,
        coil,
        kind,
        origin: Origin::default(),
    });
}

/// Adds a program named `P_name`.
pub fn program(project: &mut Project, name: &str, body: Body) {
    project.programs.push(Program {
        name: format!("P_{name}"),
        instance: format!("I_{name}"),
        description: format!("program {name}"),
        body,
        origin: Origin::default(),
    });
}

/// A machine with modes, a child that they start and abort, and rungs of odd shapes.
pub fn sample() -> Project {
    let mut p = project("Sample");
    let start = global(&mut p, "Start", Role::Input, Some("%IX0.0"));
    let stop = global(&mut p, "Stop", Role::Input, Some("%IX0.1"));
    let there = global(&mut p, "There", Role::Input, Some("%IX0.2"));
    let motor = global(&mut p, "Motor", Role::Output, Some("%QX0.0"));
    let lamp = global(&mut p, "Lamp", Role::Output, Some("%QX0.1"));
    let always = global(&mut p, "Always", Role::Output, Some("%QX0.2"));
    let f_off = global(&mut p, "X_Off", Role::StepFlag, None);
    p.globals[f_off].initial = Value::Bool(true);
    let f_run = global(&mut p, "X_Run", Role::StepFlag, None);
    let f_out = global(&mut p, "X_Run_Out", Role::StepFlag, None);
    let f_back = global(&mut p, "X_Run_Back", Role::StepFlag, None);
    let f_rest = global(&mut p, "X_Run_Rest", Role::StepFlag, None);
    let seen = global(&mut p, "Seen", Role::Variable, None);
    let c_go = global(&mut p, "C_Go", Role::Condition, None);

    let mut conditions = Ladder::default();
    rung(&mut conditions, &all([on(start), off(stop)]), c_go, CoilKind::Plain);
    program(&mut p, "Conditions", Body::Ladder(conditions));

    let mut modes = Sfc::default();
    let s_off = step(&mut modes, "Off", Some(f_off));
    let s_run = step(&mut modes, "Run", Some(f_run));
    transition(&mut modes, s_off, s_run, on(c_go));
    transition(&mut modes, s_run, s_off, on(stop));
    program(&mut p, "Modes", Body::Sfc(modes));

    let mut run = Sfc::default();
    let idle = step(&mut run, "Idle", None);
    let out = step(&mut run, "Out", Some(f_out));
    let back = step(&mut run, "Back", Some(f_back));
    let rest = step(&mut run, "Rest", Some(f_rest));
    transition(&mut run, idle, out, on(f_run));
    transition(&mut run, out, idle, off(f_run));
    transition(&mut run, out, back, all([on(f_run), on(there)]));
    transition(&mut run, back, idle, off(f_run));
    transition(&mut run, back, rest, all([on(f_run), off(there), on(start)]));
    transition(&mut run, back, out, all([on(f_run), off(there), off(start)]));
    transition(&mut run, rest, idle, off(f_run));
    transition(&mut run, rest, out, all([on(f_run), Expr::xor(on(start), on(seen))]));
    program(&mut p, "Run", Body::Sfc(run));

    let mut outputs = Ladder::default();
    rung(&mut outputs, &any([on(f_out), all([on(f_back), off(there), off(stop)])]), motor, CoilKind::Plain);
    rung(&mut outputs, &any([on(f_rest), off(f_run), on(f_off)]), lamp, CoilKind::Plain);
    rung(&mut outputs, &Expr::TRUE, always, CoilKind::Plain);
    rung(
        &mut outputs,
        &any([all([on(there), on(f_out)]), all([on(there), on(f_back)]), on(stop)]),
        seen,
        CoilKind::Set,
    );
    rung(&mut outputs, &on(f_off), seen, CoilKind::Reset);
    program(&mut p, "Outputs", Body::Ladder(outputs));
    p
}
