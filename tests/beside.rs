//! A transition from one region of a parallel state into another leaves that state and enters it anew.

use chartwright::base::Code;
use chartwright::pipeline::{self, Dialect, Options};
use chartwright::simulate::scenario;

/// A press with two sides; `lines` stand beside its regions, `more` beside it.
fn press(lines: &str, more: &str, scenario: &str) -> String {
    format!(
        "machine Press inputs {{ Up Down Swap }} outputs {{ LAMP BELL }} variables {{ Gone : BOOL  Come : BOOL }}
         actuator Lamp onoff by LAMP  actuator Bell onoff by BELL
         chart C {{
           initial parallel state Both {{
             entry set Come
             exit set Gone
             region L {{ initial state L1  state L2 {{ drives LAMP }}  from L1 to L2 when Up  from L2 to L1 when Down }}
             region R {{ initial state R1  state R2 {{ initial state In  state Out {{ drives BELL }}  from In to Out when Up }}
                         from R1 to R2 when Down  from R2 to R1 when Down }}
             region T {{ initial state T1  state T2  from T1 to T2 when Up }}
             {lines}
           }}
           {more}
         }}
         {scenario}"
    )
}

#[test]
fn the_parallel_state_is_left_and_entered_anew() {
    let cases = [
        // A state of the other region, and one inside a state of it.
        (
            "from L2 to R2 when Swap",
            "",
            "press Up expect in(L2) and in(T2) and not Gone press Swap
             expect in(R2) and in(In) and Gone and Come
             expect in(L1) and in(T1) and not LAMP",
        ),
        (
            "from L2 to R2.Out when Swap then reset Come",
            "",
            "press Up press Swap expect in(Out) and BELL and in(L1) and in(T1) and Gone and Come",
        ),
        // Written further out, into a history: what is not named begins anew, what is named goes on.
        (
            "",
            "from L2 to history of R2 when Swap",
            "press Up press Down press Up expect in(Out) and in(L2) press Swap expect in(Out) and in(L1) and in(T1)",
        ),
        // The target's region stands where it is told to stand, also if it stood there before.
        (
            "from R2.Out to L2 when Swap",
            "",
            "press Down press Up expect in(Out) and in(L2) press Swap expect in(L2) and in(R1) and in(T1) and Gone",
        ),
    ];
    for (lines, more, steps) in cases {
        let source = press(lines, more, &format!("scenario \"s\" {{ {steps} }}"));
        for dialect in [Dialect::Beremiz, Dialect::Codesys] {
            let options = Options { dialect, created: "2000-01-01T00:00:00".into(), prove: true };
            let (output, diagnostics) = pipeline::build(&source, &options);
            assert!(output.is_some(), "{source}\n{diagnostics:#?}");
        }
        let machine = pipeline::check(&source).0.expect("it was built");
        for (program, run) in pipeline::programs(&machine) {
            let verdict = scenario::play(&machine, run, 0, &mut |_, _| {});
            assert!(verdict.failure.is_none(), "{program}: {:?}\n{source}", verdict.failure);
        }
    }
}

#[test]
fn a_chart_is_never_left() {
    let source = "machine M inputs { Go } outputs { LAMP } actuator Lamp onoff by LAMP
         chart C {
           region A { initial state A1 { drives LAMP }  from A1 to B1 when Go }
           region B { initial state B1 }
         }";
    let codes: Vec<Code> = pipeline::check(source).1.iter().map(|d| d.code).collect();
    assert!(codes.contains(&Code::WrongKind), "{codes:?}");
}
