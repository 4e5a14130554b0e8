//! PLC programs with one thing wrong.

use super::rng::Rng;
use chartwright::base::Id;
use chartwright::ir::expr::Expr;
use chartwright::ir::iec::{
    Association, Atom, Body, Bool, Coil, CoilKind, Condition, Kind, Project, Qualifier, Scope, Statement, Target, VarId,
};

/// One damaged program, and what was done to it.
pub struct Mutant {
    pub project: Project,
    pub what: String,
}

/// Damages a copy of `project`, or finds that the chosen damage does not fit.
pub fn mutant(project: &Project, rng: &mut Rng) -> Option<Mutant> {
    let mut m = Mutant { project: project.clone(), what: String::new() };
    let p = rng.below(m.project.programs.len());
    let name = m.project.programs[p].name.clone();
    let what = if rng.below(40) == 0 {
        whole(&mut m.project, p, rng)?
    } else {
        let mut done = None;
        let mut body = std::mem::replace(&mut m.project.programs[p].body, Body::Code(Vec::new()));
        match &mut body {
            Body::Code(statements) => done = code(&m.project, statements, rng),
            Body::Sfc(sfc) => {
                let variables = &m.project;
                done = sfc_damage(variables, sfc, rng).or(done);
            }
        }
        m.project.programs[p].body = body;
        done?
    };
    m.what = format!("{name}: {what}");
    Some(m)
}

fn whole(project: &mut Project, p: usize, rng: &mut Rng) -> Option<String> {
    match rng.below(3) {
        0 => {
            let q = rng.below(project.programs.len());
            if p == q {
                return None;
            }
            project.programs.swap(p, q);
            Some(format!("changes places with {}", project.programs[p].name))
        }
        1 => {
            project.programs.remove(p);
            // Scopes of programs are indices; the compiler's programs have no variables of their own.
            assert!(project.variables.values().all(|v| v.scope == Scope::Global));
            Some("is left out".into())
        }
        _ => {
            let v: VarId = Id::from_index(rng.below(project.variables.len()));
            if project.variables[v].address.is_some() {
                return None;
            }
            // The other value of a BOOL, a near one of an integer.
            project.variables[v].initial ^= 1;
            Some(format!("{} begins with the other value", project.variables[v].name))
        }
    }
}

fn code(project: &Project, statements: &mut Vec<Statement>, rng: &mut Rng) -> Option<String> {
    if statements.is_empty() {
        return None;
    }
    let i = rng.below(statements.len());
    let name = |v: VarId| project.variables[v].name.clone();
    let coil_of = |s: &Statement| match s {
        Statement::Coil(c) => name(c.variable),
        _ => "?".into(),
    };
    match rng.below(12) {
        0 => {
            let s = statements.remove(i);
            Some(format!("rung of {} is left out", coil_of(&s)))
        }
        1 if i + 1 < statements.len() => {
            statements.swap(i, i + 1);
            Some(format!("rungs of {} and {} change places", coil_of(&statements[i + 1]), coil_of(&statements[i])))
        }
        2 => {
            let other = rng.below(statements.len());
            statements.swap(i, other);
            (i != other).then(|| {
                format!("rungs of {} and {} change places", coil_of(&statements[other]), coil_of(&statements[i]))
            })
        }
        3 => {
            let Statement::Coil(Coil { kind, variable, .. }) = &mut statements[i] else { return None };
            let all = [CoilKind::Plain, CoilKind::Set, CoilKind::Reset];
            let new = all[rng.below(3)];
            if new == *kind {
                return None;
            }
            *kind = new;
            Some(format!("coil {} becomes {new:?}", name(*variable)))
        }
        4 => {
            let Statement::Coil(Coil { variable, .. }) = &mut statements[i] else { return None };
            let other = any_variable(project, rng);
            let was = std::mem::replace(variable, other);
            (was != other).then(|| format!("coil {} becomes {}", name(was), name(other)))
        }
        _ => {
            let Statement::Coil(Coil { condition, variable, .. }) = &mut statements[i] else { return None };
            let what = condition_damage(project, condition, rng)?;
            Some(format!("rung of {}: {what}", name(*variable)))
        }
    }
}

fn any_variable(project: &Project, rng: &mut Rng) -> VarId {
    // What takes a number cannot take a condition: no tool would let that pass.
    loop {
        let v = Id::from_index(rng.below(project.variables.len()));
        if project.variables[v].kind == Kind::Bool {
            return v;
        }
    }
}

fn sfc_damage(project: &Project, sfc: &mut chartwright::ir::iec::Sfc, rng: &mut Rng) -> Option<String> {
    let steps: Vec<String> = sfc.steps.values().map(|s| s.name.clone()).collect();
    let count = sfc.transitions.len();
    if count == 0 {
        return None;
    }
    let t = rng.below(count);
    let about = |sfc: &chartwright::ir::iec::Sfc, t: usize| {
        let t = &sfc.transitions[t];
        format!("{} -> {}", steps[t.from[0].index()], steps[t.to[0].index()])
    };
    match rng.below(14) {
        0 => {
            let what = about(sfc, t);
            sfc.transitions.remove(t);
            Some(format!("{what} is left out"))
        }
        1 => {
            let what = about(sfc, t);
            let to = Id::from_index(rng.below(steps.len()));
            if sfc.transitions[t].to[0] == to {
                return None;
            }
            sfc.transitions[t].to = vec![to];
            Some(format!("{what} leads to {}", steps[to.index()]))
        }
        2 => {
            let what = about(sfc, t);
            let from = Id::from_index(rng.below(steps.len()));
            if sfc.transitions[t].from[0] == from {
                return None;
            }
            sfc.transitions[t].from = vec![from];
            Some(format!("{what} comes from {}", steps[from.index()]))
        }
        3 => {
            let u = rng.below(count);
            let (a, b) = (sfc.transitions[t].priority, sfc.transitions[u].priority);
            if a == b || sfc.transitions[t].from != sfc.transitions[u].from {
                return None;
            }
            sfc.transitions[t].priority = b;
            sfc.transitions[u].priority = a;
            Some(format!("{} and {} change priorities", about(sfc, t), about(sfc, u)))
        }
        4 => {
            sfc.transitions[t].priority.take()?;
            Some(format!("{} has no priority", about(sfc, t)))
        }
        5 => {
            let value = rng.below(2) == 1;
            let what = about(sfc, t);
            sfc.transitions[t].condition = Condition::simple(Expr::Const(value));
            Some(format!("condition of {what} is always {value}"))
        }
        6 => {
            let (i, j) = (rng.below(steps.len()), rng.below(steps.len()));
            let (a, b) = (Id::from_index(i), Id::from_index(j));
            if i == j || sfc.steps[a].associations == sfc.steps[b].associations {
                return None;
            }
            let mine = std::mem::take(&mut sfc.steps[a].associations);
            let other = std::mem::replace(&mut sfc.steps[b].associations, mine);
            sfc.steps[a].associations = other;
            Some(format!("{} and {} change actions", steps[i], steps[j]))
        }
        7 => {
            let i = rng.below(steps.len());
            sfc.steps[Id::from_index(i)].associations.pop()?;
            Some(format!("{} does nothing", steps[i]))
        }
        8 => {
            let i = rng.below(steps.len());
            let all = [Qualifier::Set, Qualifier::Reset, Qualifier::Pulse, Qualifier::PulseFalling];
            let qualifier = all[rng.below(all.len())];
            sfc.steps[Id::from_index(i)].associations.first_mut()?.qualifier = qualifier;
            Some(format!("action of {} becomes {qualifier:?}", steps[i]))
        }
        9 => {
            let i = rng.below(steps.len());
            let target = Target::Variable(any_variable(project, rng));
            let extra = Association { target, qualifier: Qualifier::NonStored, duration: 0 };
            let Target::Variable(v) = target else { unreachable!() };
            sfc.steps[Id::from_index(i)].associations.push(extra);
            Some(format!("{} acts on {} as well", steps[i], project.variables[v].name))
        }
        10 if rng.below(4) == 0 => {
            let i = rng.below(steps.len());
            for (k, step) in (0..steps.len()).map(|k| (k, Id::from_index(k))) {
                sfc.steps[step].initial = k == i;
            }
            (i > 0).then(|| format!("{} is the initial step", steps[i]))
        }
        _ => {
            let what = about(sfc, t);
            let done = condition_damage(project, &mut sfc.transitions[t].condition, rng)?;
            Some(format!("{what}: {done}"))
        }
    }
}

/// Damages one place of a condition.
fn condition_damage(project: &Project, condition: &mut Condition, rng: &mut Rng) -> Option<String> {
    let parts = condition.shared.len() + 1;
    let i = rng.below(parts);
    let e = if i + 1 == parts { &mut condition.value } else { &mut condition.shared[i] };
    let mut places = 0;
    count(e, &mut places);
    let mut at = rng.below(places);
    let what = rng.below(6);
    let other = any_variable(project, rng);
    change(project, e, &mut at, what, other)
}

fn count(e: &Bool, n: &mut usize) {
    *n += 1;
    match e {
        Expr::Const(_) | Expr::Atom(_) => {}
        Expr::Not(e) => count(e, n),
        Expr::And(es) | Expr::Or(es) => es.iter().for_each(|e| count(e, n)),
        Expr::Xor(l, r) => {
            count(l, n);
            count(r, n);
        }
    }
}

/// Walks to place `at` and changes what stands there.
fn change(project: &Project, e: &mut Bool, at: &mut usize, what: usize, other: VarId) -> Option<String> {
    if *at > 0 {
        *at -= 1;
        return match e {
            Expr::Const(_) | Expr::Atom(_) => None,
            Expr::Not(e) => change_in(project, std::slice::from_mut(&mut **e), at, what, other),
            Expr::And(es) | Expr::Or(es) => change_in(project, es, at, what, other),
            Expr::Xor(l, r) => {
                let found = change_in(project, std::slice::from_mut(&mut **l), at, what, other);
                found.or_else(|| change_in(project, std::slice::from_mut(&mut **r), at, what, other))
            }
        };
    }
    let shown = |e: &Bool| match e {
        Expr::Atom(Atom::Variable(v)) => project.variables[*v].name.clone(),
        Expr::Not(e) => match &**e {
            Expr::Atom(Atom::Variable(v)) => format!("not {}", project.variables[*v].name),
            _ => "not (...)".into(),
        },
        Expr::And(es) => format!("a series of {}", es.len()),
        Expr::Or(es) => format!("{} branches", es.len()),
        _ => "...".into(),
    };
    match (what, &mut *e) {
        (0 | 1, e) => {
            let was = shown(e);
            *e = std::mem::replace(e, Expr::TRUE).not();
            Some(format!("{was} is negated"))
        }
        (2, Expr::And(es)) => {
            *e = Expr::Or(std::mem::take(es));
            Some("a series becomes parallel".into())
        }
        (2, Expr::Or(es)) => {
            *e = Expr::And(std::mem::take(es));
            Some("parallel branches become a series".into())
        }
        (3 | 4, Expr::And(es) | Expr::Or(es)) if es.len() > 1 => {
            let i = other.index() % es.len();
            let gone = es.remove(i);
            Some(format!("{} is left out", shown(&gone)))
        }
        (5, Expr::Atom(Atom::Variable(v))) => {
            let was = std::mem::replace(v, other);
            (was != other).then(|| format!("{} becomes {}", project.variables[was].name, project.variables[other].name))
        }
        _ => None,
    }
}

fn change_in(project: &Project, es: &mut [Bool], at: &mut usize, what: usize, other: VarId) -> Option<String> {
    for e in es {
        let mut places = 0;
        count(e, &mut places);
        if *at < places {
            return change(project, e, at, what, other);
        }
        *at -= places;
    }
    None
}
