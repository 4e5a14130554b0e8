//! Parallel branches before a coil: which of them the generator of Beremiz writes, and at which it fails.
//!
//! Both lists were found by drawing shapes by chance and having them written by it. A letter is a contact, `-` a line
//! without one; `.` stands between what is in series, `+` between what is parallel.

use crate::support::st::{self, read_as};

const WRITTEN: &str = "A+B A+B+C (A+B)+C (A+B).- (A+B).C -.(A+B) A+(-.B) A+(B+C) A.(B+C) (A+B)+C+D (A+B).C.- (A+B).C.D (A+B+C)+D \
    (A+B+C).D -.(A+B+C) A+(B+C)+D A+(B+C+D) A+B+(C+D) A.(B+C).D A.(B+C+D) A.B.(C+D) (A+(B+C)).D (A+B)+(C+D) \
    (A+B).(C+D) (A+B).(C.-) (A+B).(C.D) (A+B+C)+D+E (A+B+C).D.E (A.B)+(C.D) (A.B).(C+D) A+(B+(C+D)) A+(B+C+D)+E \
    A+B+(-.C.-) A+B+(C+D+E) A.(B+C+D).E A.(B.(C+D)) A.B.(C+D+E) ((A+B).-)+C+D ((A+B+C)+D)+E ((A+B+C)+D).E \
    (A+(B+C)+D)+E (A+(B+C+D))+E (A+B)+(C+D)+E (A+B)+(C+D+E) (A+B).(C+D).E (A+B).(C+D+E) (A+B).(C.D).E (A+B).(C.D.E) \
    (A+B).-.(C.D) (A+B).C.(D+E) (A+B).C.(D.E) (A+B+C)+(D+E) (A+B+C).(D+E) (A+B+C).(D.E) (A.(B+C).D).E (A.B)+(-.C.D) \
    (A.B)+(C.D.E) (A.B).(C+D).E (A.B).(C+D+E) (A.B).C.(D+E) (A.B.(C+D)).E (A.B.C)+(D.E) (A.B.C).(D+E) A+(B+(C+D))+E \
    A+(B+C)+(D+E) A.((B+C+D)+E) A.(B+C).(D+E) A.(B.C).(D+E) ((A+B+C)+D+E).F (A+B)+(C+D+E)+F (A+B).(C+D+E).F \
    (A+B).(C.D.E).F (A+B).C.(D.E.F) (A+B+(C+D))+E+F (A+B+(C+D+E)).F (A+B+C)+(D+E)+F (A+B+C)+(D+E+F) (A+B+C).(D+E).F \
    (A+B+C).(D+E+F) (A+B+C).(D.E).F (A+B+C).(D.E.F) (A+B+C).-.(D+E) (A+B+C).D.(E.F) (A.(B+C).D).E.F (A.B.C)+(D.-.E) \
    (A.B.C)+(D.E.F) (A.B.C).(D+E).F (A.B.C).(D+E+F) (A.B.C).D.(E+F) -.(A.B.C).(D+E) A+((B+C)+(D+E)) A+(B+(C+D+E))+F \
    A+(B+C)+(D+E+F) A+(B+C+D)+(E+F) A.((B+C)+(D+E)) A.(B+(C+D+E)+F) A.(B+C).(D.E.F) A.(B+C+D).(E+F) A.(B.(C+D+E)).F \
    A.(B.C).(D+E+F) A.(B.C.D).(E+F) A.B.(C+(D+E)+F)";

const FAILS: &str = "-+A A+- -+A+B A+-+B A+B+- (A+-).B (A+B)+- (A.B)+- (A.B)+C -+(A.B) A+(B+-) A+(B.C) A.(-+B) A.(B+-) (A+-)+B+C \
    (A.B)+C+D (A.B.C)+D -+(A.B)+C -+(A.B.-) -+A+(B+C) -+A+(B.C) A+(-+B)+C A+(B+C+-) A+(B.C)+D A+(B.C.D) A+-+(B.C) \
    ((A+B).C)+D ((A.B)+C).- (A+-).(B.C) (A+-+B).C.D (A+B)+(C.D) (A+B).(C+-) (A.(B+C))+D (A.(B.C))+D (A.B)+(C+D) \
    (A.B.C)+D+- (A.B.C)+D+E A+((-+B).C) A+((B.C)+D) A+((B.C).D) A+(B.(C+D)) A+(B.C.D)+E A+-+(B.C.D) A+B+(C.D.E) \
    A.(B+-+C).D A.(B+C+-).D ((-+A+B)+-)+- ((A+-+B)+C).D ((A.B)+C+D)+E ((A.B).C)+D+E ((A.B.C)+D).E ((A.B.C).D)+E \
    (-+A+B).(C.D) (-.A)+B+(C.D) (-.A.B)+(C+D) (A+(-+B+C)).D (A+(B.C)+D)+E (A+(B.C.D))+E (A+(B.C.D)).E (A+B)+(C.D)+E \
    (A+B)+(C.D.E) (A+B).(C+D+-) (A+B+(C.D)).E (A+B+C)+(D.E) (A.(B+-+C)).D (A.-)+(B.C.-) (A.-.B)+(C+D) (A.B)+(C+D)+E \
    (A.B)+(C+D+E) (A.B)+(C.D)+E (A.B)+C+(D.E) (A.B.C)+(D+E) -.(A+(B+-)).C -.(A+B+(C.D)) A+((B.C.D).E) A+(B+(C+D)+-) \
    A+(B+-+(C.D)) A+(B+C)+(-+D) A+(B+C)+(D+-) A+(B+C)+(D.E) A+(B.(C.D.E)) A+(B.C)+(D.E) A+(B.C.(D+E)) A+(B.C.(D.E)) \
    A+-+((B.C).D) A.((-+B+C)+D) ((A+B)+-+-).C.D (-+A+B).(C.D.E) (A+B)+(C.D.E)+F (A+B)+C+(-+D+E) (A+B)+C+(D.E.F) \
    (A+B).(C+D+-).E (A+B+C)+(D.E)+F (A+B+C)+(D.E.F) (A+B+C)+D+(E.F) (A.(B+C+D).E)+F (A.(B.C.D))+E+F (A.B)+(C+(D.E)) \
    (A.B)+(C.D.E)+F (A.B)+C+(D+E+F) (A.B.(-+C+D))+E (A.B.C)+(D+E)+F (A.B.C)+(D+E+-) (A.B.C)+(D+E+F) (A.B.C)+D+(E+F) \
    (A.B.C)+D+(E.-) -+(-.A.(B+C+D)) -+(A.B.(C+D+E)) -.(-+A+B).(C+D) A+(-+(B.C.D)+E) A+(B+(C.D.E)+F) A+(B+C)+(D.E.F) \
    A+(B+C+D)+(-+E) A+(B+C+D)+(E.F) A+(B.C)+(D+E+F) A+(B.C)+(D.E.F) A+(B.C.(D+E+F)) A+(B.C.D)+(E+F) A+(B.C.D)+(E.F) \
    A+B+((C+D+-)+E) A+B+(C.D.(E.F)) A.(B+(C.D.E)+-)";

/// A body that is being drawn.
#[derive(Default)]
struct Drawing {
    elements: String,
    count: usize,
}

impl Drawing {
    fn element(&mut self, tag: &str, from: &[usize], variable: &str) -> usize {
        self.count += 1;
        let number = self.count + 1;
        let lines: String = from.iter().map(|n| format!(r#"<connection refLocalId="{n}"/>"#)).collect();
        self.elements += &format!(
            r#"<{tag} localId="{number}"><connectionPointIn>{lines}</connectionPointIn><variable>{variable}</variable></{tag}>"#
        );
        number
    }

    /// Draws a shape behind what comes from `from`, up to its end or a closing parenthesis; returns its ends.
    fn shape(&mut self, text: &mut std::str::Chars<'_>, from: &[usize]) -> Vec<usize> {
        let (mut ends, mut before) = (Vec::new(), from.to_vec());
        loop {
            before = match text.next().expect("a part") {
                '(' => self.shape(text, &before),
                '-' => before,
                letter => vec![self.element("contact", &before, &letter.to_string())],
            };
            let next = text.next();
            if next == Some('.') {
                continue;
            }
            for end in std::mem::replace(&mut before, from.to_vec()) {
                if !ends.contains(&end) {
                    ends.push(end);
                }
            }
            if next != Some('+') {
                return ends;
            }
        }
    }
}

fn drawn(shape: &str) -> String {
    let mut drawing = Drawing::default();
    let ends = drawing.shape(&mut shape.chars(), &[1]);
    drawing.element("coil", &ends, "Q");
    let variables = ["A", "B", "C", "D", "E", "F", "G", "H", "I", "Q"].map(|name| (name, "BOOL"));
    st::file(&variables, &format!(r#"<LD><leftPowerRail localId="1"/>{}</LD>"#, drawing.elements))
}

#[test]
fn branches_are_read_that_the_generator_of_beremiz_writes_and_no_others() {
    let mut wrong = Vec::new();
    for (shapes, written) in [(WRITTEN, true), (FAILS, false)] {
        for shape in shapes.split_whitespace() {
            let read = read_as(&drawn(shape));
            let refused = read.starts_with("E602") && read.contains("parallel branches of unequal shape");
            if refused == written || refused == read.starts_with("Q := ") {
                wrong.push(format!("{shape}: {read}"));
            }
            let codesys = read_as(&drawn(shape).replace("tc6_0201", "tc6_0200"));
            assert!(codesys.starts_with("Q := "), "{shape}: {codesys}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_lies_before_an_end_is_of_bounded_length() {
    let series = |count: usize| vec!["A"; count].join(".");
    assert!(read_as(&drawn(&series(399))).starts_with("Q := "));
    let found = read_as(&drawn(&series(400)));
    assert!(found.contains("more than 400 elements in a row before coil `Q`"), "{found}");
}

#[test]
fn boxes_in_parallel_branches_are_refused_in_codesys() {
    let timer = |from: usize| {
        format!(
            r#"<block localId="50" typeName="TON" instanceName="T"><inputVariables><variable formalParameter="IN"><connectionPointIn><connection refLocalId="{from}"/></connectionPointIn></variable></inputVariables><inOutVariables/><outputVariables><variable formalParameter="Q"/></outputVariables></block>"#
        )
    };
    let read = |lines: &str| {
        let more = r#"<contact localId="60"><connectionPointIn><connection refLocalId="50" formalParameter="Q"/></connectionPointIn><variable>B</variable></contact>"#;
        let body = format!(
            r#"<LD><leftPowerRail localId="1"/><contact localId="2"><connectionPointIn><connection refLocalId="1"/></connectionPointIn><variable>A</variable></contact>{}{more}<coil localId="70"><connectionPointIn>{lines}</connectionPointIn><variable>C</variable></coil></LD>"#,
            timer(1)
        );
        let file = st::file(&[("A", "BOOL"), ("B", "BOOL"), ("C", "BOOL"), ("T", "TON")], &body);
        read_as(&file.replace("tc6_0201", "tc6_0200"))
    };
    let line = |from: usize| format!(r#"<connection refLocalId="{from}"/>"#);
    assert_eq!(read(&line(60)), "Ton T in true; C := (T.Q and B)");
    for lines in [line(2) + &line(60), line(60) + &line(2), line(50) + &line(2)] {
        let found = read(&lines);
        assert!(found.contains("a box in one of the parallel branches before coil `C`"), "{lines}: {found}");
    }
}
