//! Names as IEC 61131-3 has them.
//!
//! A legal name is `[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*`, is no keyword, and two names that differ
//! only by case are the same name (IEC 61131-3, 2.1.2). The keyword list joins the standard's words
//! with those on which widespread PLC IDEs stumble.

/// The form in which names are compared: IEC names have no case.
pub fn fold(name: &str) -> String {
    name.to_ascii_uppercase()
}

/// Why a name is no legal IEC identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illegal {
    /// It is empty or begins with something other than a letter.
    FirstCharacter,
    /// It holds a character other than letters, digits and `_` of ASCII.
    Character(char),
    /// It holds `__`.
    DoubleUnderscore,
    /// It ends in `_`.
    TrailingUnderscore,
    /// It is a word of IEC 61131-3 or of a widespread PLC IDE.
    Keyword,
}

/// Says what keeps `name` from being a legal identifier, if anything does.
pub fn illegal(name: &str) -> Option<Illegal> {
    if let Some(c) = name.chars().find(|c| !c.is_ascii_alphanumeric() && *c != '_') {
        return Some(Illegal::Character(c));
    }
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Some(Illegal::FirstCharacter);
    }
    if name.contains("__") {
        return Some(Illegal::DoubleUnderscore);
    }
    if name.ends_with('_') {
        return Some(Illegal::TrailingUnderscore);
    }
    is_keyword(name).then_some(Illegal::Keyword)
}

/// The address of a bit in its one spelling: upper case, without leading zeros; one to four numbers below
/// 65,536. `area` is `I` or `Q`.
pub fn bit_address(address: &str, area: char) -> Option<String> {
    let upper = address.to_ascii_uppercase();
    let numbers = upper.strip_prefix(&format!("%{area}X"))?;
    let parts: Vec<String> = numbers
        .split('.')
        .map(|n| {
            let digits = !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
            digits.then(|| n.parse::<u16>().ok()).flatten().map(|n| n.to_string())
        })
        .collect::<Option<_>>()?;
    (parts.len() <= 4).then(|| format!("%{area}X{}", parts.join(".")))
}

/// Whether `name`, in any case, is a word that a PLC IDE keeps to itself.
pub fn is_keyword(name: &str) -> bool {
    KEYWORDS.binary_search(&fold(name).as_str()).is_ok()
}

/// Sorted, upper case. Words of IEC 61131-3 tables C.1 and C.2, standard functions and function
/// blocks, elementary types, and single words that the generated C of an open compiler cannot bear
/// (`ON`, `X`, `T`).
const KEYWORDS: &[&str] = &[
    "ABS",
    "ABSTRACT",
    "ACOS",
    "ACTION",
    "ADD",
    "AND",
    "ANDN",
    "ANY",
    "ANY_BIT",
    "ANY_DATE",
    "ANY_INT",
    "ANY_NUM",
    "ANY_REAL",
    "ARRAY",
    "ASIN",
    "AT",
    "ATAN",
    "BOOL",
    "BY",
    "BYTE",
    "CAL",
    "CALC",
    "CALCN",
    "CASE",
    "CLASS",
    "CLK",
    "CONCAT",
    "CONFIGURATION",
    "CONSTANT",
    "CONTINUE",
    "COS",
    "CTD",
    "CTU",
    "CTUD",
    "D",
    "DATE",
    "DATE_AND_TIME",
    "DELETE",
    "DINT",
    "DIV",
    "DO",
    "DS",
    "DT",
    "DWORD",
    "ELSE",
    "ELSIF",
    "EN",
    "END_ACTION",
    "END_CASE",
    "END_CONFIGURATION",
    "END_FOR",
    "END_FUNCTION",
    "END_FUNCTION_BLOCK",
    "END_IF",
    "END_PROGRAM",
    "END_REPEAT",
    "END_RESOURCE",
    "END_STEP",
    "END_STRUCT",
    "END_TRANSITION",
    "END_TYPE",
    "END_VAR",
    "END_WHILE",
    "ENO",
    "EQ",
    "EXIT",
    "EXP",
    "EXPT",
    "EXTENDS",
    "FALSE",
    "FB",
    "FBD",
    "FINAL",
    "FIND",
    "FOR",
    "FROM",
    "FUNCTION",
    "FUNCTION_BLOCK",
    "F_EDGE",
    "F_TRIG",
    "GE",
    "GT",
    "IF",
    "IL",
    "IMPLEMENTS",
    "INITIAL_STEP",
    "INSERT",
    "INT",
    "INTERFACE",
    "INTERNAL",
    "INTERVAL",
    "JMP",
    "JMPC",
    "JMPCN",
    "L",
    "LD",
    "LDATE",
    "LDN",
    "LDT",
    "LE",
    "LEFT",
    "LEN",
    "LIMIT",
    "LINT",
    "LN",
    "LOG",
    "LREAL",
    "LT",
    "LTIME",
    "LTOD",
    "LWORD",
    "MAX",
    "METHOD",
    "MID",
    "MIN",
    "MOD",
    "MOVE",
    "MUL",
    "MUX",
    "N",
    "NAMESPACE",
    "NE",
    "NON_RETAIN",
    "NOT",
    "NULL",
    "OF",
    "ON",
    "OR",
    "ORN",
    "OVERLAP",
    "OVERRIDE",
    "P",
    "P0",
    "P1",
    "POINTER",
    "PRIORITY",
    "PRIVATE",
    "PROGRAM",
    "PROTECTED",
    "PUBLIC",
    "R",
    "READ_ONLY",
    "READ_WRITE",
    "REAL",
    "REF",
    "REFERENCE",
    "REF_TO",
    "REPEAT",
    "REPLACE",
    "RESOURCE",
    "RET",
    "RETAIN",
    "RETC",
    "RETCN",
    "RETURN",
    "RIGHT",
    "ROL",
    "ROR",
    "RS",
    "RTC",
    "R_EDGE",
    "R_TRIG",
    "S",
    "SD",
    "SEL",
    "SEMA",
    "SFC",
    "SHL",
    "SHR",
    "SIN",
    "SINGLE",
    "SINT",
    "SIZEOF",
    "SL",
    "SQRT",
    "SR",
    "ST",
    "STEP",
    "STN",
    "STRING",
    "STRUCT",
    "SUB",
    "SUPER",
    "T",
    "TAN",
    "TASK",
    "THEN",
    "THIS",
    "TIME",
    "TIME_OF_DAY",
    "TO",
    "TOD",
    "TOF",
    "TON",
    "TP",
    "TRANSITION",
    "TRUE",
    "TRUNC",
    "TYPE",
    "UDINT",
    "UINT",
    "ULINT",
    "UNION",
    "UNTIL",
    "USING",
    "USINT",
    "VAR",
    "VAR_ACCESS",
    "VAR_CONFIG",
    "VAR_EXTERNAL",
    "VAR_GLOBAL",
    "VAR_INPUT",
    "VAR_IN_OUT",
    "VAR_OUTPUT",
    "VAR_TEMP",
    "WHILE",
    "WITH",
    "WORD",
    "WSTRING",
    "X",
    "XOR",
    "XORN",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_sorted_so_that_the_search_finds_them() {
        assert!(KEYWORDS.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn names_are_judged_by_the_standard() {
        assert_eq!(illegal("Go_out2"), None);
        assert_eq!(illegal("a__b"), Some(Illegal::DoubleUnderscore));
        assert_eq!(illegal("a_"), Some(Illegal::TrailingUnderscore));
        assert_eq!(illegal("2a"), Some(Illegal::FirstCharacter));
        assert_eq!(illegal("_a"), Some(Illegal::FirstCharacter));
        assert_eq!(illegal("é"), Some(Illegal::Character('é')));
        assert_eq!(illegal("While"), Some(Illegal::Keyword));
    }
}
