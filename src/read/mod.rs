//! PLCopen XML of any origin to a PLC project as it is executed.
//!
//! It reads what Beremiz, CODESYS and their kin write, in either namespace and by either family's
//! conventions, and whatever means the same in both; of the compiler's own writer it knows nothing.
//! What has no definite meaning, or what widespread tools are known to get wrong, it refuses and
//! names the element: a wrong reading would be worse than none.
//!
//! | module | from | to |
//! | --- | --- | --- |
//! | [`xml`] | text | tree of elements |
//! | [`schema`] | place in the tree | what may stand there |
//! | [`shape`] | tree of elements | what is not interpreted, or read in two ways |
//! | [`vendor`] | what vendors add | whether it changes anything |
//! | [`plain`] | declarations as text | whether they say what the lists say |
//! | [`declarations`] | lists of variables | variables, blocks, names |
//! | [`body`] | drawn body | elements by number, lines between them |
//! | [`token`], [`st`] | structured text | tokens, then expressions and statements |
//! | [`functions`] | boxes of functions | numbers, comparisons |
//! | [`numbers`] | statements | what is computed alike in all tools |
//! | [`flow`], [`ladder`] | contacts, blocks, coils | statements |
//! | [`branches`] | parallel branches | what tools make of them otherwise than it is drawn |
//! | [`sfc`], [`order`], [`actions`] | steps and lines between them | chart |
//!
//! Nothing here recurses without a bound, and nothing panics, whatever the input.

mod actions;
mod body;
mod branches;
mod compiled;
mod declarations;
mod flow;
mod functions;
mod ladder;
mod literal;
mod numbers;
mod order;
mod plain;
mod program;
mod schema;
mod scope;
mod sfc;
mod shape;
mod st;
mod token;
mod vendor;
mod xml;

use crate::base::iec::fold;
use crate::base::{Code, Diagnostic, Diagnostics};
use crate::ir::iec::{Body, Program, Project, Scope as Place, Task, TaskId};
use program::Context;
use scope::{Globals, Names, Scope};
use std::collections::BTreeMap;
use xml::{Family, Node};

/// What is wrong with a file.
type Problem = Diagnostic;

/// Reads PLCopen XML. Without errors among the diagnostics, whose places are in `text`, there is a
/// project.
pub fn read(text: &str) -> (Option<Project>, Diagnostics) {
    let mut problems = Diagnostics::new();
    let mut project = Project::default();
    match xml::parse(text) {
        Ok(document) => match xml::root(&document) {
            Ok((root, family)) => read_project(root, family, &mut project, &mut problems),
            Err(problem) => problems.push(problem),
        },
        Err(problem) => problems.push(problem),
    }
    problems.sort();
    let project = (!problems.has_errors()).then_some(project);
    (project, problems)
}

fn read_project(root: Node<'_>, family: Family, project: &mut Project, problems: &mut Diagnostics) {
    let header = xml::child(root, "contentHeader");
    project.name = header.and_then(|n| xml::attribute(n, "name")).unwrap_or_default().to_owned();
    let table = schema::Table::of(family);
    shape::file(root, &table, family, problems);
    let file = File { root, family };
    declarations::clashing_addresses(root, problems);
    let globals = read_globals(file, project, problems);
    let types = read_types(file, problems);
    let mut examined = Vec::new();
    for instance in instances(file, &types, project, problems) {
        if !examined.contains(&instance.pou) {
            examined.push(instance.pou);
            shape::program(instance.pou, &table, family, problems);
        }
        let body = read_program(&instance, family, &globals, project, problems);
        let Instance { name, task, pou } = instance;
        let kind = xml::attribute(pou, "name").unwrap_or_default().to_owned();
        project.programs.push(Program { name, kind, task, body });
    }
}

/// A whole file.
#[derive(Clone, Copy)]
struct File<'a> {
    root: Node<'a>,
    family: Family,
}

impl<'a> File<'a> {
    /// The elements of that name that tools of the family find: directly within one of `parents`, or as
    /// CODESYS has it, within vendor data.
    fn find(self, name: &str, parents: &[&str], problems: &mut Diagnostics) -> Vec<Node<'a>> {
        let mut found = Vec::new();
        let mut open = vec![self.root];
        while let Some(node) = open.pop() {
            let parent = node.parent().filter(|n| n.is_element());
            if xml::is(node, name) {
                match parent.map(|p| (p, p.tag_name().name())) {
                    Some((data, "data")) if vendor::holds(data, node) => found.push(node),
                    Some((_, parent)) if parents.contains(&parent) => found.push(node),
                    _ => problems.push(xml::not_understood(format!("`{name}` at this place"), node)),
                }
            }
            let namespace = self.root.tag_name().namespace();
            let inner = xml::children(node).filter(|n| {
                n.tag_name().namespace() == namespace && (self.family == Family::Codesys || !xml::is(*n, "addData"))
            });
            let first = open.len();
            open.extend(inner);
            open[first..].reverse();
        }
        found
    }
}

/// The global variables, in configurations, resources and vendor data of CODESYS.
fn read_globals(file: File<'_>, project: &mut Project, problems: &mut Diagnostics) -> Globals {
    let mut globals = Globals::default();
    let mut unlocated = None;
    for list in file.find("globalVars", &["configuration", "resource"], problems) {
        globals.lists.extend(xml::attribute(list, "name").map(fold));
        if file.family == Family::Beremiz {
            declarations::located_first(list, &mut unlocated, problems);
            declarations::small_letters(list, problems);
        }
        declarations::declare(list, Place::Global, &mut globals.names, project, problems);
    }
    globals
}

/// The program organisation units by folded name, wherever they stand.
fn read_types<'a>(file: File<'a>, problems: &mut Diagnostics) -> BTreeMap<String, Node<'a>> {
    let mut types = BTreeMap::new();
    for kind in file.find("dataType", &["dataTypes"], problems) {
        refuse_standard_name(kind, problems);
    }
    for pou in file.find("pou", &["pous"], problems) {
        let Some(name) = xml::attribute(pou, "name") else { continue };
        refuse_standard_name(pou, problems);
        if file.family == Family::Beremiz
            && let Some(what) = compiled::unit(pou)
        {
            problems.push(xml::not_understood(what, pou));
        }
        if types.insert(fold(name), pou).is_some() {
            problems.push(xml::problem(Code::Clash, format!("two programs have the name `{name}`"), pou));
        }
    }
    types
}

/// What a file declares anew is not what the standard says of that name.
fn refuse_standard_name(node: Node<'_>, problems: &mut Diagnostics) {
    let name = xml::attribute(node, "name").unwrap_or_default();
    if declarations::is_known(name) || functions::is_known(name) {
        problems.push(xml::not_understood(format!("a `{name}` other than that of the standard"), node));
    }
}

/// A program that runs.
struct Instance<'a> {
    name: String,
    task: Option<TaskId>,
    pou: Node<'a>,
}

/// The programs that run, in the order in which they do: task by task, then those without a task.
/// Where nothing runs, the file was exported without tasks, and all programs run as they stand.
fn instances<'a>(
    file: File<'a>,
    types: &BTreeMap<String, Node<'a>>,
    project: &mut Project,
    problems: &mut Diagnostics,
) -> Vec<Instance<'a>> {
    let mut list = Vec::new();
    let resources = file.find("resource", &["configuration"], problems);
    let several: Vec<_> = match file.family {
        Family::Beremiz => resources.clone(),
        Family::Codesys => resources.iter().copied().filter(|r| xml::child(*r, "task").is_some()).collect(),
    };
    if let [_, second, ..] = several[..] {
        problems.push(xml::not_understood("a second resource", second));
    }
    if let [_, second, ..] = file.find("configuration", &["configurations"], problems)[..] {
        problems.push(xml::not_understood("a second configuration", second));
    }
    let tasks = file.find("task", &["resource"], problems);
    refuse_other_priorities(&tasks, problems);
    for task in tasks {
        // Tasks of CODESYS interrupt each other.
        if file.family == Family::Codesys && !list.is_empty() && xml::child(task, "pouInstance").is_some() {
            problems.push(xml::not_understood("a second task with programs", task));
        }
        match read_task(task, file.family) {
            Ok(read) => {
                let id = project.tasks.push(read);
                list.extend(xml::children_named(task, "pouInstance").map(|n| (n, Some(id))));
            }
            Err(problem) => problems.push(problem),
        }
    }
    for resource in resources {
        for instance in xml::children_named(resource, "pouInstance") {
            if file.family == Family::Codesys {
                problems.push(xml::not_understood("a program without a task", instance));
            }
            list.push((instance, None));
        }
    }
    let programs = types.values().filter(|n| xml::attribute(**n, "pouType") == Some("program"));
    if list.is_empty() {
        let mut programs: Vec<_> = programs.copied().collect();
        programs.sort_by_key(|n| n.range().start);
        let name = |n: Node<'a>| xml::attribute(n, "name").unwrap_or_default().to_owned();
        return programs.into_iter().map(|pou| Instance { name: name(pou), task: None, pou }).collect();
    }
    let mut names = BTreeMap::new();
    let mut instances = Vec::new();
    for (node, task) in list {
        match read_instance(node, task, types, file.family) {
            Ok(instance) => {
                if names.insert(fold(&instance.name), ()).is_some() {
                    let message = format!("two instances have the name `{}`", instance.name);
                    problems.push(xml::problem(Code::Clash, message, node));
                }
                instances.push(instance);
            }
            Err(problem) => problems.push(problem),
        }
    }
    instances
}

/// Beremiz runs tasks in the order in which they stand, others the most urgent first: 0 is that.
fn refuse_other_priorities(tasks: &[Node<'_>], problems: &mut Diagnostics) {
    let mut last = 0;
    for &task in tasks.iter().filter(|task| xml::child(**task, "pouInstance").is_some()) {
        let Some(text) = xml::attribute(task, "priority") else { continue };
        match text.parse::<u16>() {
            Ok(priority) if priority < last => {
                problems.push(xml::not_understood("a task that stands after one of lower priority", task));
            }
            Ok(priority) => last = priority,
            Err(_) => problems.push(xml::problem(Code::BrokenText, format!("`{text}` is no priority of a task"), task)),
        }
    }
}

fn read_task(node: Node<'_>, family: Family) -> Result<Task, Problem> {
    let name = xml::required(node, "name")?.to_owned();
    let Some(text) = xml::attribute(node, "interval") else {
        return Err(xml::not_understood(format!("task `{name}` without an interval"), node));
    };
    let broken = || xml::problem(Code::BrokenText, format!("`{text}` is no interval of a task"), node);
    let other = || xml::not_understood(format!("task `{name}`, whose vendor settings say something else,"), node);
    // Beremiz puts the text into a program as it stands.
    let literal = text.split_once('#').is_some_and(|(_, rest)| !rest.to_ascii_lowercase().contains("us"));
    if family == Family::Beremiz && !literal {
        return Err(broken());
    }
    let written = literal::interval(text).ok_or_else(broken)?;
    let interval = match vendor::interval(node) {
        // TwinCAT says the time there alone.
        Ok(Some(interval)) if written == 0 => interval,
        Ok(Some(interval)) if interval != written => return Err(other()),
        Ok(_) => written,
        Err(()) => return Err(other()),
    };
    if interval > 0 { Ok(Task { name, interval }) } else { Err(broken()) }
}

fn read_instance<'a>(
    node: Node<'a>,
    task: Option<TaskId>,
    types: &BTreeMap<String, Node<'a>>,
    family: Family,
) -> Result<Instance<'a>, Problem> {
    let name = xml::required(node, "name")?;
    // CODESYS leaves it empty: an instance is its program.
    let kind = xml::attribute(node, "typeName").unwrap_or(name);
    if family == Family::Codesys && !kind.eq_ignore_ascii_case(name) {
        return Err(xml::not_understood(format!("`{name}`, an instance of `{kind}` under another name,"), node));
    }
    match types.get(&fold(kind)) {
        Some(&pou) if xml::attribute(pou, "pouType") == Some("program") => {
            Ok(Instance { name: name.to_owned(), task, pou })
        }
        Some(_) => Err(xml::not_understood(format!("`{kind}`, which is no program, as an instance"), node)),
        None => Err(xml::problem(Code::Undeclared, format!("there is no program `{kind}`"), node)),
    }
}

/// Declares the variables of a program and reads its body.
fn read_program(
    instance: &Instance<'_>,
    family: Family,
    globals: &Globals,
    project: &mut Project,
    problems: &mut Diagnostics,
) -> Body {
    let place = Place::Program(project.programs.len());
    let mut locals = Names::new();
    for list in xml::child(instance.pou, "interface").into_iter().flat_map(xml::children) {
        match list.tag_name().name() {
            "localVars" | "inputVars" | "outputVars" => {
                if family == Family::Beremiz {
                    declarations::small_letters(list, problems);
                }
                declarations::declare(list, place, &mut locals, project, problems);
            }
            "externalVars" => declarations::import(list, globals, &mut locals, project, problems),
            "documentation" | "addData" => {}
            other => problems.push(xml::not_understood(format!("`{other}` of a program"), list)),
        }
    }
    let visible = (family == Family::Codesys).then_some(globals);
    let scope = Scope { locals, globals: visible, steps: BTreeMap::new() };
    let Project { variables, blocks, .. } = project;
    let mut context = Context { family, scope, place, variables, blocks, problems };
    let body = read_body(instance.pou, &mut context);
    if let Some(what) = numbers::objection(&body, context.variables) {
        context.report(xml::not_understood(format!("{what}, in this program,"), instance.pou));
    }
    body
}

fn read_body(pou: Node<'_>, context: &mut Context<'_, '_>) -> Body {
    let Some(body) = xml::child(pou, "body") else {
        context.report(xml::problem(Code::Unconnected, "a program has no body", pou));
        return Body::Code(Vec::new());
    };
    match xml::child(body, "SFC") {
        Some(content) => Body::Sfc(sfc::read(pou, content, context)),
        None => match actions::statements(body, context) {
            Ok(statements) => Body::Code(statements),
            Err(problem) => {
                context.report(problem);
                Body::Code(Vec::new())
            }
        },
    }
}
