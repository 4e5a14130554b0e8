//! The compiler's own project straight to the executable form, past writer and reader.

use chartwright::base::{Arena, Id};
use chartwright::ir::expr::Expr;
use chartwright::ir::ladder;
use chartwright::ir::{iec, plc};

/// What the project means, if the writer loses nothing.
pub fn executable(project: &plc::Project) -> iec::Project {
    let mut out = iec::Project { name: project.name.clone(), ..iec::Project::default() };
    let mut ids = Vec::new();
    for g in project.globals.values() {
        ids.push(out.variables.push(iec::Variable {
            name: g.name.clone(),
            scope: iec::Scope::Global,
            kind: iec::Kind::Bool,
            initial: i64::from(g.initial),
            address: g.address.clone(),
        }));
    }
    let atom = |g: plc::GlobalId| Expr::Atom(iec::Atom::Variable(ids[g.index()]));
    let task =
        out.tasks.push(iec::Task { name: project.task.name.clone(), interval: i64::from(project.task.interval) * 1000 });
    for program in &project.programs {
        let body = match &program.body {
            plc::Body::Ladder(l) => iec::Body::Code(
                l.rungs
                    .iter()
                    .map(|r| {
                        let products = r.condition.products().iter().map(|p| {
                            Expr::all(p.literals().iter().map(|l| if l.negated { atom(l.atom).not() } else { atom(l.atom) }))
                        });
                        iec::Statement::Coil(iec::Coil {
                            condition: iec::Condition::simple(Expr::any(products.collect::<Vec<_>>())),
                            variable: ids[r.coil.index()],
                            kind: match r.kind {
                                ladder::CoilKind::Plain => iec::CoilKind::Plain,
                                ladder::CoilKind::Set => iec::CoilKind::Set,
                                ladder::CoilKind::Reset => iec::CoilKind::Reset,
                            },
                        })
                    })
                    .collect(),
            ),
            plc::Body::Sfc(sfc) => {
                let mut steps = Arena::new();
                for (id, s) in sfc.steps.iter() {
                    steps.push(iec::Step {
                        name: s.name.clone(),
                        initial: id == sfc.initial(),
                        associations: s
                            .flag
                            .iter()
                            .map(|f| iec::Association {
                                target: iec::Target::Variable(ids[f.index()]),
                                qualifier: iec::Qualifier::NonStored,
                                duration: 0,
                            })
                            .collect(),
                    });
                }
                let step = |s: chartwright::ir::sfc::StepId| Id::from_index(s.index());
                let transitions = sfc
                    .transitions
                    .iter()
                    .map(|t| iec::Transition {
                        from: vec![step(t.from)],
                        to: vec![step(t.to)],
                        priority: Some(t.priority),
                        condition: iec::Condition::simple(t.condition.map(&mut |g| atom(*g))),
                    })
                    .collect();
                iec::Body::Sfc(iec::Sfc { steps, transitions, actions: Arena::new() })
            }
        };
        out.programs.push(iec::Program {
            name: program.instance.clone(),
            kind: program.name.clone(),
            task: Some(task),
            body,
        });
    }
    out
}
