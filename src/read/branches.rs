//! Parallel branches to whether a tool makes of them what is drawn.
//!
//! Beremiz writes what feeds an end as nested lists and sorts the branches of each junction. Its language does not
//! compare a contact with a series of contacts, nor a series that begins with a junction with one that does not: there
//! its generator breaks off. Branches that begin at the rail with the same elements are one branch to it up to
//! where they part.
//!
//! CODESYS and its kin put boxes that stand in parallel branches one behind the other.

use super::Problem;
use super::body::{Body, describe};
use super::xml::{self, Family, Node};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Longest way from the rail to an end; the generator follows it with one call in another.
const DEEP: usize = 400;

/// How many parts of branches are looked at for one end.
const PARTS: usize = 500_000;

/// What lies before a point, as Beremiz writes it: the nearest part first.
#[derive(Debug, PartialEq, Eq)]
enum Path {
    /// The rail itself.
    Rail,
    /// A contact, a value or the output of a box.
    Word(usize, String),
    /// One behind the other.
    Series(Vec<Rc<Path>>),
    /// A junction.
    Parallel(Vec<Rc<Path>>),
}

/// Why branches cannot be sorted.
enum Objection {
    Unequal,
    Large,
}

/// What is known of the elements before one end.
pub struct Branches<'b, 'a> {
    body: &'b Body<'a>,
    family: Family,
    /// The path of each element that is no box, and how far it is from the rail.
    paths: BTreeMap<usize, (Rc<Path>, usize)>,
    /// Elements that are boxes, or have some before them.
    boxes: BTreeMap<usize, bool>,
    /// How much may still be looked at.
    left: usize,
}

impl<'b, 'a> Branches<'b, 'a> {
    /// Nothing known yet.
    pub fn new(body: &'b Body<'a>, family: Family) -> Self {
        Branches { body, family, paths: BTreeMap::new(), boxes: BTreeMap::new(), left: PARTS }
    }

    /// Looks at an element all of whose sources have been looked at.
    pub fn add(&mut self, element: usize) -> Result<(), Problem> {
        let node = self.body.elements[element];
        match self.family {
            Family::Codesys => {
                let some = xml::is(node, "block") || self.boxes_before(node)?;
                self.boxes.insert(element, some);
            }
            Family::Beremiz if matches!(node.tag_name().name(), "contact" | "coil") => {
                let (before, depth) = self.before(node)?;
                let junction = self.body.lines(node)?.len() > 1;
                let path = match node.tag_name().name() {
                    "contact" => series(Path::Word(element, String::new()), before, junction),
                    _ => Path::Series(before),
                };
                self.paths.insert(element, (Rc::new(path), depth + 1));
            }
            Family::Beremiz => {}
        }
        Ok(())
    }

    /// Looks at the lines into `end`.
    pub fn end(&mut self, end: Node<'a>) -> Result<(), Problem> {
        match self.family {
            Family::Codesys => self.boxes_before(end).map(|_| ()),
            Family::Beremiz => self.before(end).map(|_| ()),
        }
    }

    /// Whether boxes stand before one; fails where they stand in parallel branches.
    fn boxes_before(&self, end: Node<'a>) -> Result<bool, Problem> {
        let lines = self.body.lines(end)?;
        let some = lines.iter().any(|line| self.boxes.get(&line.from).copied().unwrap_or(false));
        if some && lines.len() > 1 {
            let what = format!("a box in one of the parallel branches before {}", describe(end));
            return Err(xml::not_understood(what, end));
        }
        Ok(some)
    }

    /// What lies before one, sorted if it is a junction, and how far it is from the rail.
    fn before(&mut self, end: Node<'a>) -> Result<(Vec<Rc<Path>>, usize), Problem> {
        let (mut paths, mut depth) = (Vec::new(), 0);
        for line in self.body.lines(end)? {
            let source = self.body.elements[line.from];
            let (path, far) = match (source.tag_name().name(), self.paths.get(&line.from)) {
                (_, Some((path, far))) => (path.clone(), *far),
                ("leftPowerRail", None) => (Rc::new(Path::Rail), 0),
                (_, None) => (Rc::new(Path::Word(line.from, line.parameter.unwrap_or_default().to_owned())), 0),
            };
            depth = depth.max(far);
            paths.push(path);
        }
        if depth >= DEEP {
            return Err(xml::not_understood(
                format!("more than {DEEP} elements in a row before {}", describe(end)),
                end,
            ));
        }
        if paths.len() > 1 {
            paths = self.sorted(paths).map_err(|objection| {
                let what = match objection {
                    Objection::Unequal => {
                        "parallel branches of unequal shape, at which the generator of Beremiz fails,"
                    }
                    Objection::Large => "a junction of so many branches",
                };
                xml::not_understood(format!("{}: {what}", describe(end)), end)
            })?;
        }
        Ok((paths, depth))
    }

    /// The branches of a junction as the generator sorts them, those with the same beginning taken together.
    fn sorted(&mut self, paths: Vec<Rc<Path>>) -> Result<Vec<Rc<Path>>, Objection> {
        self.left = self.left.checked_sub(paths.len() * paths.len()).ok_or(Objection::Large)?;
        let (mut result, mut single) = (Vec::new(), Vec::new());
        let mut alike: Vec<(Rc<Path>, Vec<Rc<Path>>)> = Vec::new();
        for path in paths {
            match &*path {
                Path::Series(parts) if parts.len() > 1 => {
                    let last = &parts[parts.len() - 1];
                    match alike.iter_mut().find(|(first, _)| first == last) {
                        Some((_, members)) => members.push(path),
                        None => alike.push((last.clone(), vec![path])),
                    }
                }
                Path::Series(_) => single.push(path),
                Path::Rail | Path::Word(..) | Path::Parallel(_) => result.push(path),
            }
        }
        for (last, members) in alike {
            if let [only] = members.as_slice() {
                single.push(only.clone());
                continue;
            }
            let heads = members.iter().map(|member| match &**member {
                Path::Series(parts) => Rc::new(Path::Series(parts[..parts.len() - 1].to_vec())),
                _ => member.clone(),
            });
            let mut parts = self.sorted(heads.collect())?;
            if parts.len() > 1 {
                parts = vec![Rc::new(Path::Parallel(parts))];
            }
            parts.push(last);
            result.push(Rc::new(Path::Series(parts)));
        }
        result.append(&mut single);
        let each = |i: usize| result[i + 1..].iter().all(|other| comparable(&result[i], other));
        if (0..result.len()).all(each) { Ok(result) } else { Err(Objection::Unequal) }
    }
}

/// A contact and what lies before it.
fn series(contact: Path, before: Vec<Rc<Path>>, junction: bool) -> Path {
    match before.as_slice() {
        [only] => match &**only {
            Path::Rail => contact,
            Path::Series(rest) if !junction => {
                Path::Series([Rc::new(contact)].into_iter().chain(rest.iter().cloned()).collect())
            }
            Path::Word(..) | Path::Series(_) | Path::Parallel(_) => Path::Series(vec![Rc::new(contact), only.clone()]),
        },
        _ => Path::Series(vec![Rc::new(contact), Rc::new(Path::Parallel(before))]),
    }
}

/// Whether the one can be sorted before or after the other.
fn comparable(left: &Path, right: &Path) -> bool {
    match (left, right) {
        (Path::Word(..), Path::Word(..)) => true,
        (Path::Series(left), Path::Series(right)) => {
            left.iter().zip(right).find(|(l, r)| l != r).is_none_or(|(l, r)| comparable(l, r))
        }
        // In which order they stand within depends on names.
        (Path::Parallel(left), Path::Parallel(right)) => {
            left.iter().all(|l| right.iter().all(|r| l == r || comparable(l, r)))
        }
        (Path::Rail | Path::Word(..) | Path::Series(_) | Path::Parallel(_), _) => false,
    }
}
