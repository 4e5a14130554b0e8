//! The text form of PLC projects, and the table of names.

use crate::support::plc;
use chartwright::base::LineIndex;
use chartwright::emit::names::table;
use chartwright::ir::plc::{Body, Origin, Role};
use chartwright::ir::sfc::Sfc;
use chartwright::ir::text;
use chartwright::pipeline;

#[test]
fn an_sfc_reads_like_a_list() {
    insta::assert_snapshot!(text::sfc(&plc::sample()), @r"
    SFC P_Modes: program Modes

      S_Off, initial, N X_Off: step Off
        1: S_Off -> S_Run when C_Go

      S_Run, N X_Run: step Run
        1: S_Run -> S_Off when Stop

    SFC P_Run: program Run

      S_Idle, initial: step Idle
        1: S_Idle -> S_Out when X_Run

      S_Out, N X_Run_Out: step Out
        1: S_Out -> S_Idle when NOT X_Run
        2: S_Out -> S_Back when X_Run AND There

      S_Back, N X_Run_Back: step Back
        1: S_Back -> S_Idle when NOT X_Run
        2: S_Back -> S_Rest when X_Run AND NOT There AND Start
        3: S_Back -> S_Out when X_Run AND NOT There AND NOT Start

      S_Rest, N X_Run_Rest: step Rest
        1: S_Rest -> S_Idle when NOT X_Run
        2: S_Rest -> S_Out when X_Run AND (Start XOR Seen)
    ");
}

#[test]
fn a_ladder_reads_like_a_ladder() {
    insta::assert_snapshot!(text::ladder(&plc::sample()), @r"
    LD P_Conditions: program Conditions

      C_Go: rung 0
      |--[ Start ]--[/Stop ]--( C_Go )--|

    LD P_Outputs: program Outputs

      Motor: rung 0
      |--[ X_Run_Out  ]-----------------------+--( Motor )--|
      |--[ X_Run_Back ]--[/There ]--[/Stop ]--+

      Lamp: rung 1
      |--[ X_Run_Rest ]--+--( Lamp )--|
      |--[/X_Run      ]--+
      |--[ X_Off      ]--+

      Always: rung 2
      |--( Always )--|

      Seen: rung 3
      |--[ There ]--[ X_Run_Out  ]--+--(S Seen )--|
      |--[ There ]--[ X_Run_Back ]--+
      |--[ Stop  ]------------------+

      Seen: rung 4
      |--[ X_Off ]--(R Seen )--|
    ");
}

#[test]
fn a_name_leads_back_to_the_model() {
    let source = "machine Small cycle 10ms\nvariables { b : BOOL }\nchart C { initial state Idle }\n";
    let (machine, _) = pipeline::check(source);
    let machine = machine.expect("there is a machine");
    let mut project = plc::project("Small");
    let g = plc::global(&mut project, "Odd", Role::Variable, None);
    project.globals[g].description = "says \"no\",\nthen yes".to_owned();
    let b = machine.variables.ids().next().expect("it has a variable");
    project.globals[g].origin = Origin::Variable(b);
    let mut sfc = Sfc::default();
    plc::step(&mut sfc, "Idle", None);
    plc::program(&mut project, "Region", Body::Sfc(sfc));
    insta::assert_snapshot!(table(&project, &machine, &LineIndex::new(source)), @r#"
    name,kind,program,model,line,column,description
    Odd,variable,,variable b,2,13,"says ""no"",
    then yes"
    P_Region,program,,,,,program Region
    I_Region,instance,P_Region,,,,program Region
    S_Idle,step,P_Region,,,,step Idle
    ,machine,,machine Small,,,"Small, built by hand"
    "#);
}
