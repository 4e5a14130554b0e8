//! Observers, rule by rule, on machines whose scans can be followed by hand.

use chartwright::base::Code;
use chartwright::pipeline;
use chartwright::simulate::chart::Chart;

const HEAD: &str = "machine M cycle 10ms inputs { A1 B1 } outputs { Out1 Out2 } variables { V1 : BOOL V2 : BOOL } \
    actuator Act1 onoff by Out1 actuator Act2 onoff by Out2 ";

const CHART: &str = "chart C { initial state P { drives Out1 when A1 drives Out2 when B1 } }";

/// Runs one scan for each word, the inputs that are TRUE or `-` for none: what is TRUE then of states,
/// variables and outputs, in order of declaration, then what integers are that are not 0.
#[track_caller]
fn assert_run(rest: &str, inputs: &str, wanted: &[&str]) {
    let (machine, diagnostics) = pipeline::check(&format!("{HEAD}{rest}"));
    let machine = machine.unwrap_or_else(|| panic!("{rest}: {diagnostics:?}"));
    let mut chart = Chart::new(&machine);
    let scans = inputs.split(' ').map(|now| {
        chart.scan(&[now.contains('a'), now.contains('b')]);
        let integers = machine.integers.iter().filter(|(id, _)| chart.integer(*id) != 0);
        let integers = integers.map(|(id, i)| format!("{}={}", i.name, chart.integer(id)));
        let states = machine.states.iter().filter(|(id, _)| chart.is_active(*id)).map(|(_, s)| s.name.as_str());
        let variables = machine.variables.iter().filter(|(id, _)| chart.variable(*id)).map(|(_, v)| v.name.as_str());
        let outputs = machine.outputs.iter().filter(|(id, _)| chart.output(*id)).map(|(_, o)| o.name.as_str());
        let names = states.chain(variables).chain(outputs).map(str::to_owned);
        names.chain(integers).collect::<Vec<_>>().join(" ")
    });
    assert_eq!(scans.collect::<Vec<_>>(), wanted, "{rest}");
}

fn codes(rest: &str) -> Vec<Code> {
    let found = pipeline::check(&format!("{HEAD}{rest}")).1;
    found.iter().map(|d| d.code).filter(|c| c.number().starts_with('E')).collect()
}

#[test]
fn all_that_follows_sees_the_new_state() {
    let observed = "observer O { initial state N  state Y  from N to Y when A1 then set V1  from Y to N when not A1 then reset V1 }";
    let chart = "chart C { initial state P  state Q { drives Out1 when in(Y) drives Out2 when V1 } \
        from P to Q when in(Y) and V1 from Q to P when in(N) } safety supervisor { S1: never Out2 and in(Y) and B1 }";
    assert_run(
        &format!("{observed} {chart}"),
        "- a ab a -",
        &["N P", "Y Q V1 Out1 Out2", "Y Q V1 Out1", "Y Q V1 Out1 Out2", "N P"],
    );
}

#[test]
fn observers_move_together() {
    // Each hands the token on to the other; neither order of declaration makes a difference.
    let first = "observer O1 { initial state F1 state G1 from F1 to G1 when in(F2) from G1 to F1 when in(G2) }";
    let second = "observer O2 { initial state F2 state G2 from F2 to G2 when in(F1) from G2 to F2 when in(G1) }";
    assert_run(&format!("{first} {second} {CHART}"), "- - -", &["F1 F2 P", "G1 G2 P", "F1 F2 P"]);
    assert_run(&format!("{second} {first} {CHART}"), "- - -", &["F2 F1 P", "G2 G1 P", "F2 F1 P"]);
}

#[test]
fn set_at_the_end_and_reset_at_the_beginning_of_a_scan() {
    let observer = "observer O { initial state N state Y from Y to N when B1 \
        after filter { from N to Y when rise(Out1) then set V1 } }";
    // In the second scan it is already set and no edge; in the last one it is reset, and set again.
    let chart = "chart C { initial state P { drives Out1 when A1 and in(N) } }";
    assert_run(
        &format!("{observer} {chart}"),
        "a a ab b a ab",
        &["Y P V1 Out1", "Y P V1", "Y P V1 Out1", "N P V1", "Y P V1 Out1", "N P V1 Out1"],
    );
}

#[test]
fn after_the_filter_outputs_are_what_it_let_through() {
    let observer =
        "observer O { initial state N state Y after filter { from N to Y when Out1 from Y to N when fall(Out1) } }";
    let safety = "safety supervisor { S1: never Out1 and B1 }";
    assert_run(&format!("{observer} {CHART} {safety}"), "ab a ab a", &["N P Out2", "Y P Out1", "N P Out2", "Y P Out1"]);
}

#[test]
fn the_end_of_the_first_scan_counts() {
    let observer =
        "observer O { initial state N state Y from N to Y when true after filter { from Y to N when true } }";
    let chart = "chart C { initial state P { drives Out1 when in(Y) } }";
    // At the beginning nothing fires, at the end nothing has to.
    assert_run(&format!("{observer} {chart}"), "- - -", &["N P", "N P Out1", "N P Out1"]);
    let observer = "observer O { initial state N state Y after filter { from N to Y when rise(Out1) } }";
    assert_run(&format!("{observer} {CHART}"), "a -", &["Y P Out1", "Y P"]);
}

#[test]
fn both_parts_have_an_order_of_their_own() {
    let observer = "observer O { initial state N state Y state Z from N to Y priority 1 when A1 from Y to N when B1 \
        from Z to N when true after filter { from N to Z when Out2 from N to Y priority 1 when Out1 } }";
    assert_run(&format!("{observer} {CHART}"), "ab - b -", &["Y P Out1 Out2", "Y P", "Z P Out2", "N P"]);
}

#[test]
fn states_of_one_observer_exclude_each_other() {
    let observer = |n: usize| format!("observer O{n} {{ initial state N{n} state Y{n} from N{n} to Y{n} when A1 }}");
    let safety = |a: &str, b: &str| {
        let own = observer(1) + &observer(2);
        format!("{own} {CHART} safety supervisor {{ S1: never Out1 and in({a}) S2: never not Out1 and in({b}) }}")
    };
    assert_eq!(codes(&safety("N1", "Y1")), []);
    assert_eq!(codes(&safety("N1", "Y2")), [Code::ContradictingConstraints]);
}

#[test]
fn constraints_may_name_an_observer_before_its_state() {
    let observer = "observer O { initial state N state Y from N to Y when A1 }";
    let asks =
        |condition: &str| codes(&format!("{observer} {CHART} safety supervisor {{ S1: never Out1 and {condition} }}"));
    assert_eq!(asks("in(O.Y)"), []);
    assert_eq!(asks("not in(O.N)"), []);
    assert_eq!(asks("in(C.P)"), [Code::WrongKind]);
    assert_eq!(asks("in(O.P)"), [Code::UnknownName]);
}

#[test]
fn nobody_else_writes_what_an_observer_writes() {
    let observer = "observer O { initial state N state Y from N to Y when A1 then set V1 from Y to N when V1 }";
    let chart = "chart C { initial state P from P to P when B1 then reset V1 }";
    assert_eq!(codes(&format!("{observer} {CHART}")), []);
    assert_eq!(codes(&format!("{observer} {chart}")), [Code::ObserverReads, Code::ParallelWrites]);
}

#[test]
fn what_an_observer_counts_is_seen_in_the_same_scan() {
    let integers = "variables { N1 : 0..3  N2 : 0..9 }";
    // `N1` counts scans with `A1`; the chart copies and compares what it is after that, the observer what it was.
    let observer = "observer O { initial state N  state Y { entry set N1 := N1 + 1  internal when A1 then set N1 := N1 + 1 } \
        from N to Y when A1  from Y to N when not A1 and N1 = 2 }";
    let chart = "chart C { initial state P { drives Out1 when N1 = 2  internal when A1 then set N2 := N1 }  state Q \
        from P to Q priority 1 when N1 >= 3 }";
    assert_run(
        &format!("{integers} {observer} {chart}"),
        "- a a - - a a",
        &[
            "N P",
            "Y P N1=1 N2=1",
            "Y P Out1 N1=2 N2=2",
            "N P Out1 N1=2 N2=2",
            "N P Out1 N1=2 N2=2",
            "Y Q N1=3 N2=2",
            "Y Q N1=3 N2=2",
        ],
    );
}

#[test]
fn counted_after_the_filter() {
    let integers = "variables { N1 : 0..9  N2 : 0..9 }";
    // What is assigned at the end is computed from what the beginning has left, exit before effect before entry;
    // the filter has seen what was there before.
    let observer = "observer O { initial state N { exit set N1 := N1 + 2, set V1 }  state Y { entry set N2 := N1 + 1 } \
        from Y to N when true then set N1 := N1 + 1 \
        after filter { from N to Y when rise(Out1) then set N1 := N1 + 3, reset V1 } }";
    let safety = "safety supervisor { S1: never rise(Out1) and N1 > 5 }";
    assert_run(
        &format!("{integers} {observer} {CHART} {safety}"),
        "- a - a - a",
        &["N P", "Y P Out1 N1=3 N2=1", "N P N1=4 N2=1", "Y P Out1 N1=7 N2=5", "N P N1=8 N2=5", "N P N1=8 N2=5"],
    );
}

#[test]
fn what_an_observer_cannot_be() {
    let observer = |inside: &str| {
        format!(
            "variables {{ N1 : 0..9 N2 : 0..9 }} events {{ E1 }} observer O {{ initial state N state Y {inside} }} \
             chart C {{ initial state P {{ internal when A1 or N2 = 1 or E1 then set N1 := 1 - N1 }} }}"
        )
    };
    for (inside, code) in [
        ("from N to Y when in(P)", Code::ObserverReads),
        ("from N to Y when Out1", Code::WrongKind),
        ("after filter { from N to Y when A1 and after 10ms }", Code::NotFlat),
        ("from Y to N when after 10ms after filter { from N to Y when A1 }", Code::NotFlat),
        ("state Z { initial state X } from Y to Z when B1 after filter { from N to Y when A1 }", Code::NotFlat),
        ("state Z { sets V1 } from N to Z when A1 from N to Y when B1", Code::ObserverActs),
        ("from N to Y when N1 = 1", Code::ObserverReads),
        ("from N to Y when A1 then set N2 := N1", Code::ObserverReads),
        ("state Z { entry set N2 := 1 - N1 } from N to Z when A1 from N to Y when B1", Code::ObserverReads),
        ("from N to Y when A1 then set N1 := 0", Code::ParallelWrites),
        ("state Z { exit raise E1 } from N to Z when A1 from N to Y when B1", Code::ObserverActs),
        ("from N to C when A1", Code::UnknownName),
        ("from N to P when A1", Code::WrongKind),
    ] {
        assert!(codes(&observer(inside)).contains(&code), "{inside}: {:?}", codes(&observer(inside)));
    }
}
