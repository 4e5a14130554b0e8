//! Structured text: how it is read, with every operator, literal, block and pin, and what is refused.

use crate::support::st::{self, escaped, read_as};

const VARIABLES: [(&str, &str); 16] = [
    ("A", "BOOL"),
    ("B", "BOOL"),
    ("C", "BOOL"),
    ("I", "INT"),
    ("J", "INT"),
    ("K", "ULINT"),
    ("D", "TIME"),
    ("E", "TIME"),
    ("On", "TON"),
    ("Off", "TOF"),
    ("Pulse", "TP"),
    ("Up", "R_TRIG"),
    ("Down", "F_TRIG"),
    ("Keep", "SR"),
    ("Lose", "RS"),
    ("Word", "WORD"),
];

fn text(text: &str) -> String {
    read_as(&st::file(&VARIABLES, &format!("<ST><p>{}</p></ST>", escaped(text))))
}

#[test]
fn every_operator_binds_as_the_standard_says() {
    for (written, expected) in [
        ("A := B OR C AND NOT A;", "A := (B or (C and not A))"),
        ("A := B or C or A;", "A := (B or C or A)"),
        ("A := B XOR C XOR A;", "A := ((B xor C) xor A)"),
        ("A := B OR C XOR A;", "A := (B or (C xor A))"),
        ("A := B XOR C AND A;", "A := (B xor (C and A))"),
        ("A := B & C AND A;", "A := (B and C and A)"),
        ("A := B AND C & A;", "A := (B and C and A)"),
        ("A := B & I = J;", "A := (B and (I = J))"),
        ("A := (B OR C) AND A;", "A := ((B or C) and A)"),
        ("A := B = C;", "A := not (B xor C)"),
        ("A := B <> C;", "A := (B xor C)"),
        ("A := I < J = B;", "A := not ((I < J) xor B)"),
        ("A := B = I >= J;", "A := not (B xor (I >= J))"),
        ("A := I <> J;", "A := (I <> J)"),
        ("A := I < J;", "A := (I < J)"),
        ("A := I <= J;", "A := (I <= J)"),
        ("A := I > J;", "A := (I > J)"),
        ("A := I + 1 >= J - 2;", "A := ((I + 1) >= (J - 2))"),
        ("A := D <= E;", "A := (D <= E)"),
        ("I := I - J - 1;", "I := ((I - J) - 1)"),
        ("I := I - (J - 1);", "I := (I - (J - 1))"),
        ("D := D + E - T#2ms;", "D := ((D + E) - 2000)"),
        ("I := -J;", "I := -J"),
        ("I := - -J;", "I := J"),
        ("I := +J;", "I := J"),
        ("I := -3;", "I := -3"),
        ("I := 2 - -3;", "I := (2 - -3)"),
        ("D := -E;", "D := -E"),
        ("D := -T#3ms;", "D := -3000"),
        ("D := +E;", "D := E"),
        ("D := +T#3ms;", "D := 3000"),
        ("A := NOT B;", "A := not B"),
        ("A := NOT NOT B;", "A := B"),
        ("A := NOT NOT NOT B;", "A := not B"),
        ("A := NOT (B AND C);", "A := not (B and C)"),
        ("A := 1;", "A := true"),
        ("A := 0;", "A := false"),
        ("A := B = 1;", "A := B"),
        ("A := TRUE; B := bool#0;", "A := true; B := false"),
    ] {
        assert_eq!(text(written), expected, "{written}");
    }
}

#[test]
fn every_literal_is_read() {
    for (written, expected) in [
        ("I := 16#1F;", "I := 31"),
        ("I := 8#17;", "I := 15"),
        ("I := 2#101;", "I := 5"),
        ("I := 10#12;", "I := 12"),
        ("I := 1_000;", "I := 1000"),
        ("I := INT#-7;", "I := -7"),
        ("I := int#+7;", "I := 7"),
        ("I := INT#16#10;", "I := 16"),
        ("D := T#1d2h3m4s5ms6us;", "D := 93784005006"),
        ("D := TIME#1.5s;", "D := 1500000"),
        ("D := t#-2m;", "D := -120000000"),
        ("D := t#+2m;", "D := 120000000"),
        ("D := T#1_0ms;", "D := 10000"),
        ("A := BOOL#TRUE;", "A := true"),
        ("A := BOOL#1;", "A := true"),
        ("A := bool#FALSE;", "A := false"),
        ("A (* := *) := B // C\n;", "A := B"),
    ] {
        assert_eq!(text(written), expected, "{written}");
    }
    assert!(text("A := %IX0.0;").contains("an address stands where a name is expected"));
    for wrong in [
        "I := 16#;",
        "I := 3#1;",
        "I := 1.5;",
        "I := 1a;",
        "I := INT#--7;",
        "I := REAL#1;",
        "D := T#;",
        "D := T#1;",
        "D := T#1s1m;",
        "D := T#1s1s;",
        "D := T#1.5m1s;",
        "D := T#1.s;",
        "D := T#s;",
        "D := T#0.5us;",
        "A := BOOL#2;",
        "A := B $ C;",
        "A := %IX0.0;",
        "A := 'x';",
        "A (* := B;",
        "A := B; (* (* *) *)",
        "I := 99999999999999999999;",
        "D := T#99999999999d;",
    ] {
        assert!(text(wrong).starts_with("E605"), "{wrong}: {}", text(wrong));
    }
}

#[test]
fn every_pin_of_every_block_is_known() {
    for (written, expected) in [
        ("On(IN := A, PT := T#1s);", "Ton On in A preset 1000000"),
        ("Off(IN := A, PT := D);", "Tof Off in A preset D"),
        ("Pulse(PT := T#1ms, IN := TRUE);", "Tp Pulse in true preset 1000"),
        ("Up(CLK := A);", "RTrig Up in A"),
        ("Down(clk := A);", "FTrig Down in A"),
        ("Keep(S1 := A, R := B);", "Sr Keep in A reset B"),
        ("Keep(SET1 := A, RESET := B);", "Sr Keep in A reset B"),
        ("Lose(S := A, R1 := B);", "Rs Lose in A reset B"),
        ("Lose(SET := A, RESET1 := B);", "Rs Lose in A reset B"),
        ("On();", "Ton On"),
        ("A := On.Q; D := On.ET;", "A := On.Q; D := On.ET"),
        ("A := Off.Q; D := Off.ET;", "A := Off.Q; D := Off.ET"),
        ("A := Pulse.q; D := Pulse.et;", "A := Pulse.Q; D := Pulse.ET"),
        ("A := Up.Q OR Down.Q;", "A := (Up.Q or Down.Q)"),
        ("A := Keep.Q1 OR Lose.Q1;", "A := (Keep.Q or Lose.Q)"),
        ("On(IN := A, Q => B, ET => D);", "Ton On in A; B := On.Q; D := On.ET"),
    ] {
        assert_eq!(text(written), expected, "{written}");
    }
    for (wrong, reason) in [
        ("On(S1 := A);", "`On` has no parameter `S1`"),
        ("On(CLK := A);", "`On` has no parameter `CLK`"),
        ("Up(IN := A);", "`Up` has no parameter `IN`"),
        ("Keep(S := A);", "`Keep` has no parameter `S`"),
        ("Keep(R1 := A);", "`Keep` has no parameter `R1`"),
        ("Lose(S1 := A);", "`Lose` has no parameter `S1`"),
        ("Lose(R := A);", "`Lose` has no parameter `R`"),
        ("Up(PT := T#1s);", "`Up` has no parameter `PT`"),
        ("On(Q1 => A);", "`On` has no parameter `Q1`"),
        ("Keep(Q => A);", "`Keep` has no parameter `Q`"),
        ("Up(ET => D);", "`Up` has no parameter `ET`"),
        ("A := Keep.Q;", "`Keep.Q`"),
        ("A := On.Q1;", "`On.Q1`"),
        ("A := On.IN;", "`On.IN`"),
        ("On(IN := I);", "an input of type BOOL is given an integer"),
        ("On(IN := D);", "an input of type BOOL is given TIME"),
        ("On(PT := I);", "an input of type TIME is given an integer"),
        ("On(PT := A);", "an input of type TIME is given BOOL"),
        ("On(IN := A; PT := D);", "`)`"),
        ("On(IN = A);", "`:=`"),
        ("A(IN := B);", "the call of `A`"),
        ("F(A);", "`F` is not declared"),
    ] {
        let found = text(wrong);
        assert!(found.starts_with("E6") && found.contains(reason), "{wrong}: {found}");
    }
}

#[test]
fn a_text_that_is_no_program_is_refused() {
    for (wrong, reason) in [
        ("A := B", "the text ends where `;` is expected"),
        ("A := ;", "`;` stands where a value is expected"),
        ("A := B C;", "`C` stands where `;` is expected"),
        ("A := (B;", "`;` stands where `)` is expected"),
        ("A := B);", "`)` stands where `;` is expected"),
        ("I := 3 4;", "`4` stands where"),
        ("A := NOT I = J;", "NOT needs BOOL, this is an integer"),
        ("A := B TRUE;", "`TRUE` stands where"),
        ("A := B FALSE;", "`FALSE` stands where"),
        ("A := B T#1s;", "a duration stands where"),
        ("A := NOT;", "`;` stands where a value is expected"),
        ("A := OR B;", "`OR` stands where a value is expected"),
        ("A := B AND XOR C;", "`XOR` stands where a value is expected"),
        ("A. := B;", "`:=` stands where a name is expected"),
        ("3 := A;", "`3` stands where a name is expected"),
        ("IF A THEN B := C; END_IF;", "the statement that begins with `IF`"),
        ("RETURN;", "the statement that begins with `RETURN`"),
        ("A := B * C;", "the operator `*`"),
        ("I := I / J;", "the operator `/`"),
        ("I := I ** J;", "the operator `**`"),
        ("I := I MOD J;", "the operator `MOD`"),
        ("A := NOT I;", "NOT needs BOOL, this is an integer"),
        ("A := B AND I;", "AND needs BOOL, this is an integer"),
        ("A := I OR B;", "OR needs BOOL, this is an integer"),
        ("A := B XOR D;", "XOR needs BOOL, this is TIME"),
        ("A := -B;", "BOOL has no sign"),
        ("A := +B;", "BOOL has no sign"),
        ("A := I;", "`A` is BOOL and cannot take an integer"),
        ("A := 2;", "`A` is BOOL and cannot take an integer"),
        ("I := B;", "`I` is an integer and cannot take BOOL"),
        ("I := D;", "`I` is an integer and cannot take TIME"),
        ("D := 5;", "`D` is TIME and cannot take an integer"),
        ("A := I = D;", "an integer and TIME cannot be compared so"),
        ("A := B < C;", "BOOL and BOOL cannot be compared so"),
        ("A := B >= C;", "BOOL and BOOL cannot be compared so"),
        ("A := B = 2;", "BOOL and an integer cannot be compared so"),
        ("I := I + D;", "an integer and TIME cannot be added or subtracted"),
        ("D := D - 1;", "TIME and an integer cannot be added or subtracted"),
        ("A := On;", "`On` is a function block and has no value"),
        ("On := A;", "writing to `On`"),
        ("On.IN := A;", "writing to `On.IN`"),
        ("A := Word;", "`Word` is of type"),
        ("A := Nobody;", "`Nobody` is not declared"),
        ("A := A.B;", "`A.B`"),
        ("I := MAX(I, J);", "the function `MAX`"),
    ] {
        let found = text(wrong);
        assert!(found.starts_with("E6") && found.contains(reason), "{wrong}: {found}");
    }
    assert_eq!(text(";; A := B;; C := A;"), "A := B; C := A");
    assert_eq!(text(""), "");
}

#[test]
fn an_expression_has_a_greatest_depth() {
    let signs = |count: usize| text(&format!("I := {}J;", "J - ".repeat(count)));
    assert!(signs(127).starts_with("I := (("), "{}", signs(127));
    assert!(signs(128).contains("the expression is nested too deep"), "{}", signs(128));
    let open = |count: usize| text(&format!("A := {}B{};", "(".repeat(count), ")".repeat(count)));
    let most = chartwright::base::limits::NESTING;
    assert_eq!(open(most), "A := B");
    assert!(open(most + 1).contains("parentheses are nested too deep"), "{}", open(most + 1));
    // One after the other they are not deep.
    let flat = text(&format!("A := {}B;", "(B) OR ".repeat(most + 5)));
    assert!(flat.starts_with("A := (B or B"), "{flat}");
    let exclusive = |count: usize| text(&format!("A := {}B;", "B XOR ".repeat(count)));
    assert!(exclusive(127).starts_with("A := (("), "{}", exclusive(127));
    assert!(exclusive(128).contains("nested too deep"), "{}", exclusive(128));
    let mixed = |count: usize| text(&format!("A := {}B{};", "NOT (C AND ".repeat(count), ")".repeat(count)));
    assert!(mixed(63).starts_with("A := not (C and not"), "{}", mixed(63));
    assert!(mixed(65).contains("nested too deep"), "{}", mixed(65));
    // What stands around a chain makes it deeper: by one, but a comparison by two.
    let around =
        |count: usize, before: &str, after: &str| text(&format!("A := {before}({}B){after};", "B XOR ".repeat(count)));
    for (most, before, after) in [(126, "", " OR C"), (126, "", " AND C"), (126, "NOT ", ""), (125, "", " = C")] {
        let found = around(most, before, after);
        assert!(found.starts_with("A := "), "{before} {after}: {found}");
        let found = around(most + 1, before, after);
        assert!(found.contains("the expression is nested too deep"), "{before} {after}: {found}");
    }
    let sign = |count: usize| text(&format!("I := -({}J);", "J - ".repeat(count)));
    assert!(sign(126).starts_with("I := -("), "{}", sign(126));
    assert!(sign(127).contains("the expression is nested too deep"), "{}", sign(127));
}
