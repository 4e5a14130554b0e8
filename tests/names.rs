//! Which state a name means, wherever it stands, and what states are called where they are shown.

use chartwright::base::LineIndex;
use chartwright::ir::chart::{Guard, Inside, Machine, Transition, TransitionId};
use chartwright::ir::expr::IEC;
use chartwright::{emit, lower, pipeline};
use std::collections::BTreeSet;

fn machine(source: &str) -> Machine {
    let (machine, diagnostics) = pipeline::check(source);
    machine.unwrap_or_else(|| panic!("{source}: {diagnostics:#?}"))
}

/// A condition as a model writes it.
fn shown(m: &Machine, guard: &Guard) -> String {
    let mut out = String::new();
    guard.write(&mut out, &IEC, &mut |a, f| f.write_str(&m.atom(*a))).expect("writing to a string succeeds");
    out
}

fn codes(source: &str) -> Vec<&'static str> {
    pipeline::check(source).1.iter().map(|d| d.code.number()).collect()
}

/// A parallel state `Twice` beside a region and a state that are called like what it holds; `lines` stand
/// in its braces, `outside` beside it.
fn nested(lines: &str, outside: &str) -> String {
    format!(
        "machine M inputs {{ Go Stop }} outputs {{ LAMP OTHER }} actuator Lamp onoff by LAMP actuator Other onoff by OTHER
         chart C {{
           region A {{ initial state X  state Y  from X to Y when Go  from Y to X when Stop }}
           region D {{
             initial state B
             parallel state Twice {{
               {lines}
               region A {{ initial state X  state Y  final state E  from X to Y when Go  from Y to E when Stop }}
               region B {{ initial state X  state Y  final state E  from X to Y when Go  from Y to E when Stop }}
             }}
             from B to Twice when Go
             {outside}
           }}
         }}"
    )
}

#[test]
fn names_between_the_braces_of_a_parallel_state_are_those_of_its_regions_first() {
    let inner = |m: &Machine, path: &str| m.states.ids().find(|&s| m.state_path(s) == path).expect("a state");
    // A condition.
    let m = machine(&nested("drives LAMP when in(A.Y) and in(B.Y)", "from Twice to B when Stop"));
    let twice = inner(&m, "D.Twice");
    assert_eq!(shown(&m, &m.states[twice].drives[0].condition), "in(D.Twice.A.Y) AND in(D.Twice.B.Y)");
    // A join and a fork.
    let m = machine(&nested("from (A.Y, B.Y) to (A.E, B.E) when Stop", "from Twice to B"));
    let t = m.transitions.values().find(|t| matches!(t.inside, Inside::Fork(_))).expect("a fork");
    assert_eq!(shown(&m, &t.guard), "in(D.Twice.A.Y) AND in(D.Twice.B.Y) AND Stop");
    assert_eq!(t.goals().iter().map(|&s| m.state_path(s)).collect::<Vec<_>>(), ["D.Twice.A.E", "D.Twice.B.E"]);
    // What its regions do not have is searched further out: the state `B` beside it is hidden, `Twice` is not.
    let m = machine(&nested("from Twice to Twice when in(A.E)  from B.Y to B.X when Go and Stop", ""));
    let own: Vec<String> = m
        .transitions
        .values()
        .filter(|t| m.state_path(t.source).starts_with("D.Twice"))
        .map(|t| format!("{} -> {}", m.state_path(t.source), m.state_path(t.target)))
        .collect();
    assert!(own.contains(&"D.Twice -> D.Twice".to_owned()), "{own:?}");
    assert!(own.contains(&"D.Twice.B.Y -> D.Twice.B.X".to_owned()), "{own:?}");
    // From outside, the neighbour is meant.
    let m = machine(&nested("drives LAMP", "from Twice to B when in(A.Y)"));
    let t = m.transitions.values().find(|t| t.source == inner(&m, "D.Twice")).expect("a transition");
    assert_eq!(shown(&m, &t.guard), "in(A.Y)");
    // Within them a neighbour of that name is hidden, even where the rest of the path would lead there only.
    let hidden = nested("drives LAMP when in(A.Z)", "from Twice to B")
        .replace("initial state X  state Y  from", "initial state X  state Y  state Z  from Y to Z when Go  from");
    assert_eq!(codes(&hidden), ["E104"]);
}

#[test]
fn history_and_done_look_where_all_look() {
    let m = machine(
        "machine M inputs { Go Stop } outputs { LAMP } actuator Lamp onoff by LAMP
         chart C {
           initial state Off
           state Left { initial state In  final state Out  from In to Out when Go }
           parallel state Both {
             from Both to history of Left.Deep when done(Left.Deep)
             internal when done(Right.Deep) then set V
             drives LAMP when V
             region Left  { initial state Deep { initial state In  final state Out  from In to Out when Go }  }
             region Right { initial state Deep { initial state In  final state Out  from In to Out when Go }  }
           }
           from Off to Both when Go
           from Off to history of Left when Stop
           from Left to Off when Stop
         }
         variables { V : BOOL }",
    );
    let written = |(id, t): (TransitionId, &Transition)| format!("{} when {}", m.destination(id), shown(&m, &t.guard));
    let shown: Vec<String> = m.transitions.iter().map(written).collect();
    let own = "history of Both.Left.Deep when done(Both.Left.Deep)";
    assert!(shown.iter().any(|t| t == own), "{shown:?}");
    assert!(shown.iter().any(|t| t == "Both when done(Both.Right.Deep)"), "{shown:?}");
    assert!(shown.iter().any(|t| t == "history of Left when Stop"), "{shown:?}");
}

/// Two charts with the same states; one of them is an observer if `first` says so.
fn twins(first: &str, more: &str) -> String {
    format!(
        "machine M inputs {{ Go Stop }} outputs {{ LAMP BELL }} actuator Lamp onoff by LAMP actuator Bell onoff by BELL
         {first} Saw {{ initial state Off  state Work {{ initial state On  state Dry  from On to Dry when Go  from Dry to On when Stop }}
                        from Off to Work when Go  from Work to Off when Stop }}
         chart Drill {{ initial state Off {{ drives BELL when in(Saw.Work.Dry) }}
                        state Work {{ drives LAMP  initial state On  state Dry  from On to Dry when after 20ms  from Dry to On when Stop }}
                        from Off to Work when Go and not in(Saw.Off)  from Work to Off when Stop and after 30ms }}
         {more}"
    )
}

#[test]
fn equal_states_of_two_charts_are_told_apart_wherever_they_are_shown() {
    for first in ["chart", "observer"] {
        let source = twins(first, "");
        let m = machine(&source);
        let paths: BTreeSet<String> = m.states.ids().map(|s| m.state_path(s)).collect();
        assert_eq!(paths.len(), m.states.len(), "{paths:?}");
        assert!(paths.contains("Saw.Work.Dry") && paths.contains("Drill.Off"), "{paths:?}");
        let project = lower::lower(&m);
        let table = emit::names::table(&project, &m, &LineIndex::new(&source));
        // In one program, or outside of all, nothing is said of two things.
        let mut seen = BTreeSet::new();
        for row in table.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            if matches!(cells[1], "step flag" | "step" | "program" | "instance") {
                assert!(seen.insert((cells[1], cells[3].to_owned())) || cells[3].is_empty(), "{row}\n{table}");
            }
        }
        assert!(table.contains("\nX_Saw_Work_Dry,step flag,,state Saw.Work.Dry,"), "{table}");
    }
    // Nothing is told apart that needs no telling.
    let m = machine(
        "machine M inputs { Go } outputs { LAMP } actuator Lamp onoff by LAMP
         chart A { initial state Off  state On { drives LAMP }  from Off to On when Go }
         chart B { initial state Idle }",
    );
    assert_eq!(m.states.ids().map(|s| m.state_path(s)).collect::<Vec<_>>(), ["Off", "On", "Idle"]);
}

#[test]
fn a_path_that_reads_like_one_with_the_name_of_its_chart_is_told_apart_too() {
    let m = machine(
        "machine M inputs { Go } outputs { LAMP } actuator Lamp onoff by LAMP
         chart A { initial state X  state Z  from X to Z when Go  from Z to X when Go }
         chart B { initial state x  state Y { drives LAMP }  from x to Y when Go  from Y to x when Go }
         chart C { initial state A { initial state X  state W  from X to W when Go  from W to X when Go } }",
    );
    let paths: Vec<String> = m.states.ids().map(|s| m.state_path(s)).collect();
    assert_eq!(paths, ["A.X", "Z", "B.x", "Y", "A", "C.A.X", "A.W"]);
}

#[test]
fn constraints_ask_for_states_as_scenarios_do() {
    let constrained =
        |path: &str| twins("observer", &format!("safety supervisor {{ S1: never LAMP and in({path}) \"dry\" }}"));
    let m = machine(&constrained("Saw.Work.Dry"));
    let never = shown(&m, &m.safety.constraints.values().next().expect("a constraint").never);
    assert!(never.contains("in(Saw.Work.Dry)"), "{never}");
    // Of a chart, of both, of none.
    assert!(codes(&constrained("Drill.Work.Dry")).contains(&"E106"), "{:?}", codes(&constrained("Drill.Work.Dry")));
    assert!(codes(&constrained("Work.Dry")).contains(&"E105"), "{:?}", codes(&constrained("Work.Dry")));
    assert!(codes(&constrained("Nowhere")).contains(&"E104"), "{:?}", codes(&constrained("Nowhere")));
}

#[test]
fn an_ambiguous_name_is_said_with_more_of_its_path() {
    let source = "machine M inputs { Go } outputs { LAMP } actuator Lamp onoff by LAMP
         observer O { initial state N  state Y  from N to Y when Go }
         chart C {
           region A { initial state X  state Y  from X to Y when Go }
           region B { initial state Z { drives LAMP when in(Y) } }
         }";
    let (_, diagnostics) = pipeline::check(source);
    let ambiguous = diagnostics.iter().find(|d| d.code.number() == "E105").expect("`Y` is ambiguous");
    assert_eq!(ambiguous.help, ["write more of its path: `O.Y`, `A.Y`"]);
    for more in ["O.Y", "A.Y", "C.A.Y"] {
        assert_eq!(codes(&source.replace("in(Y)", &format!("in({more})"))), Vec::<&str>::new(), "{more}");
    }
}

#[test]
fn a_movement_stands_in_the_region_that_moves() {
    let parallel = "machine M inputs { In Out Go } outputs { PUSH } actuator Rod monostable { position Back sensor In position Front output PUSH sensor Out }
         chart C {
           initial state W
           parallel state P {
             region A controls Rod { initial state Back  state Front  INNER move from Front to Back when not Go }
             region B { initial state Z }
             OUTER
           }
           from W to P when Go
         }";
    let movement = "move from Back to Front when Go";
    assert!(codes(&parallel.replace("INNER", movement).replace("OUTER", "")).is_empty());
    let beside = codes(&parallel.replace("INNER", "").replace("OUTER", movement));
    assert!(beside.contains(&"E205"), "{beside:?}");
    let after = "machine M inputs { Go } outputs { LAMP } actuator Lamp onoff by LAMP
         observer O { initial state N  state Y  after filter { move from N to Y when Go } }
         chart C { initial state Z { drives LAMP when in(Y) } }";
    assert!(codes(after).contains(&"E205"), "{:?}", codes(after));
}
