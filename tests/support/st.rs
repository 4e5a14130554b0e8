//! Files with one program, and what the reader makes of them as text: what was written, with parentheses around
//! everything.

use chartwright::ir::expr::Expr;
use chartwright::ir::iec::{Atom, Body, Bool, CoilKind, Condition, Number, Project, Relation, Sfc, Statement, Target};
use chartwright::read;

/// A file with one program, whose variables have these names and types.
pub fn file(variables: &[(&str, &str)], body: &str) -> String {
    const BLOCKS: [&str; 7] = ["TON", "TOF", "TP", "R_TRIG", "F_TRIG", "SR", "RS"];
    let variable = |(name, kind): &(&str, &str)| {
        let kind = if BLOCKS.contains(kind) { format!(r#"<derived name="{kind}"/>"#) } else { format!("<{kind}/>") };
        format!(r#"<variable name="{name}"><type>{kind}</type></variable>"#)
    };
    let variables: String = variables.iter().map(variable).collect();
    format!(
        r#"<project xmlns="http://www.plcopen.org/xml/tc6_0201"><types><pous><pou name="P" pouType="program"><interface><localVars>{variables}</localVars></interface><body>{body}</body></pou></pous></types></project>"#
    )
}

/// What is read of a file, or what is said instead.
pub fn read_as(text: &str) -> String {
    match read::read(text) {
        (Some(project), _) => program(&project, 0).join("; "),
        (None, diagnostics) => {
            diagnostics.iter().map(|d| format!("{} {}", d.code.number(), d.message)).collect::<Vec<_>>().join("; ")
        }
    }
}

/// A text as it stands in XML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The body of the program with that number, a line for each statement, transition and action.
pub fn program(project: &Project, number: usize) -> Vec<String> {
    match &project.programs[number].body {
        Body::Code(statements) => statements.iter().map(|s| statement(s, project, None)).collect(),
        Body::Sfc(sfc) => chart(sfc, project),
    }
}

fn chart(sfc: &Sfc, project: &Project) -> Vec<String> {
    let mut lines = Vec::new();
    for step in sfc.steps.values() {
        lines.push(format!("step {}{}", step.name, if step.initial { " initial" } else { "" }));
        for a in &step.associations {
            let target = match a.target {
                Target::Variable(v) => project.variables[v].name.clone(),
                Target::Action(a) => format!("action {}", sfc.actions[a].name),
            };
            lines.push(format!("  {:?} {} {target}", a.qualifier, a.duration));
        }
    }
    for t in &sfc.transitions {
        let names = |steps: &[chartwright::ir::iec::StepId]| {
            steps.iter().map(|s| sfc.steps[*s].name.as_str()).collect::<Vec<_>>().join("+")
        };
        let priority = t.priority.map(|p| format!("{p}: ")).unwrap_or_default();
        let when = condition(&t.condition, project, Some(sfc));
        lines.push(format!("{priority}{} > {} when {when}", names(&t.from), names(&t.to)));
    }
    for a in sfc.actions.values() {
        lines.push(format!("action {}", a.name));
        lines.extend(a.body.iter().map(|s| format!("  {}", statement(s, project, Some(sfc)))));
    }
    lines
}

fn statement(statement: &Statement, project: &Project, sfc: Option<&Sfc>) -> String {
    match statement {
        Statement::Coil(coil) => {
            let kind = match coil.kind {
                CoilKind::Plain => "",
                CoilKind::Set => " set",
                CoilKind::Reset => " reset",
            };
            format!("{}{kind} := {}", project.variables[coil.variable].name, condition(&coil.condition, project, sfc))
        }
        Statement::Move { to, value } => {
            format!("{} := {}", project.variables[*to].name, self::number(value, project, sfc))
        }
        Statement::Call(call) => {
            let block = &project.blocks[call.block];
            let pin = |name: &str, c: &Option<Condition>| {
                c.as_ref().map(|c| format!(" {name} {}", condition(c, project, sfc))).unwrap_or_default()
            };
            let (input, reset) = (pin("in", &call.input), pin("reset", &call.reset));
            let preset = call.preset.as_ref().map(|n| format!(" preset {}", number(n, project, sfc)));
            let name = if block.name.is_empty() { call.block.index().to_string() } else { block.name.clone() };
            format!("{:?} {name}{input}{reset}{}", block.kind, preset.unwrap_or_default())
        }
    }
}

fn condition(condition: &Condition, project: &Project, sfc: Option<&Sfc>) -> String {
    let value = bool(&condition.value, project, sfc);
    let shared: Vec<String> = condition.shared.iter().map(|v| bool(v, project, sfc)).collect();
    if shared.is_empty() { value } else { format!("{value} with {}", shared.join(", ")) }
}

fn bool(value: &Bool, project: &Project, sfc: Option<&Sfc>) -> String {
    let list = |operands: &[Bool], sign: &str| {
        let texts: Vec<String> = operands.iter().map(|o| bool(o, project, sfc)).collect();
        format!("({})", texts.join(sign))
    };
    match value {
        Expr::Const(value) => value.to_string(),
        Expr::Not(inner) => format!("not {}", bool(inner, project, sfc)),
        Expr::And(operands) => list(operands, " and "),
        Expr::Or(operands) => list(operands, " or "),
        Expr::Xor(left, right) => format!("({} xor {})", bool(left, project, sfc), bool(right, project, sfc)),
        Expr::Atom(Atom::Variable(id)) => project.variables[*id].name.clone(),
        Expr::Atom(Atom::Step(id)) => sfc.map(|s| format!("{}.X", s.steps[*id].name)).unwrap_or_default(),
        Expr::Atom(Atom::Output(block)) => match project.blocks[*block].name.as_str() {
            "" => format!("{}.Q", block.index()),
            name => format!("{name}.Q"),
        },
        Expr::Atom(Atom::Shared(place)) => format!("shared {place}"),
        Expr::Atom(Atom::Compare(relation, left, right)) => {
            let sign = match relation {
                Relation::Equal => "=",
                Relation::Unequal => "<>",
                Relation::Less => "<",
                Relation::LessOrEqual => "<=",
                Relation::Greater => ">",
                Relation::GreaterOrEqual => ">=",
            };
            format!("({} {sign} {})", number(left, project, sfc), number(right, project, sfc))
        }
    }
}

fn number(value: &Number, project: &Project, sfc: Option<&Sfc>) -> String {
    let text = |value: &Number| number(value, project, sfc);
    match value {
        Number::Const(n) => n.to_string(),
        Number::Variable(id) => project.variables[*id].name.clone(),
        Number::StepTime(id) => sfc.map(|s| format!("{}.T", s.steps[*id].name)).unwrap_or_default(),
        Number::Elapsed(block) => format!("{}.ET", project.blocks[*block].name),
        Number::Negative(inner) => format!("-{}", text(inner)),
        Number::Sum(left, right) => format!("({} + {})", text(left), text(right)),
        Number::Difference(left, right) => format!("({} - {})", text(left), text(right)),
        Number::Limit { lowest, value, highest } => format!("limit({lowest}, {}, {highest})", text(value)),
        Number::Select { by, no, yes } => {
            format!("({} if {} else {})", text(yes), project.variables[*by].name, text(no))
        }
    }
}
