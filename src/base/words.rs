//! Words that PLCs keep to themselves, one table for each reason, and what they are there.
//!
//! Names in a PLC program have no case, so all words stand in upper case here. Signals, variables and events keep
//! their names on the way to every target; so one table refuses them for all.

use super::iec::fold;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// What `name`, in any case, is in a PLC, if it is a word there: `a keyword of IEC 61131-3`.
pub fn clash(name: &str) -> Option<&'static str> {
    let word = fold(name);
    let what = known().get(word.as_str()).copied();
    what.or_else(|| typed(&word).then_some("a standard function of IEC 61131-3 for one type"))
        .or_else(|| end_within(&word).map(|_| "a name around a keyword at which Beremiz ends a part of the program"))
}

/// `name` without the underscores that make keywords of its parts: `ENDPROGRAM_I` of `END_PROGRAM_I`.
pub fn without_ends(name: &str) -> String {
    let mut name = name.to_owned();
    while let Some(at) = end_within(&name) {
        name.remove(at + "END".len());
    }
    name
}

/// Where one of [`ENDS`] begins in a name.
fn end_within(name: &str) -> Option<usize> {
    let upper = name.to_ascii_uppercase();
    ENDS.iter().find_map(|end| upper.find(end))
}

/// All words of the tables with what they are; [`typed`] ones are not among them.
pub fn listed() -> impl Iterator<Item = (&'static str, &'static str)> {
    known().iter().map(|(word, what)| (*word, *what))
}

fn known() -> &'static BTreeMap<&'static str, &'static str> {
    static KNOWN: OnceLock<BTreeMap<&str, &str>> = OnceLock::new();
    KNOWN.get_or_init(|| {
        let mut known = BTreeMap::new();
        // A word of several tables keeps the description of the first.
        for (what, table) in TABLES.iter().rev() {
            known.extend(table.split_whitespace().map(|word| (word, *what)));
        }
        known
    })
}

/// Whether it is a function or block of the standard for one type: `ADD_INT`, `CTU_DINT`, `MUX_INT_BOOL`; or one that
/// turns one type into another: `INT_TO_REAL`, `TO_INT`, `REAL_TRUNC_INT`, `WORD_BCD_TO_UINT`, `XWORD_TO_DWORD`.
fn typed(word: &str) -> bool {
    let elementary = |word: &str| !word.starts_with("ANY") && TYPES.split_whitespace().any(|t| t == word);
    let coded = |word: &str| {
        word == "BCD" || [word.strip_suffix("_BCD"), word.strip_prefix("BCD_")].into_iter().flatten().any(elementary)
    };
    let own = |word: &str| CODESYS_TYPES.split_whitespace().any(|t| t == word);
    let either = |word: &str| elementary(word) || coded(word) || own(word);
    // A name of a type may hold `_TO_` or `_` itself, so each place is tried.
    let split = |between: &str, left: &dyn Fn(&str) -> bool, right: &dyn Fn(&str) -> bool| {
        word.match_indices(between).any(|(at, _)| left(&word[..at]) && right(&word[at + between.len()..]))
    };
    let overloaded = |word: &str| OVERLOADED.split_whitespace().any(|f| f == word);
    let selected = |word: &str| word.strip_prefix("MUX_").is_some_and(elementary);
    split("_TO_", &either, &either)
        || split("_TRUNC_", &elementary, &elementary)
        || ["TO_", "TRUNC_"].iter().any(|before| word.strip_prefix(before).is_some_and(either))
        || split("_", &|f| overloaded(f) || selected(f), &elementary)
}

/// The tables, and what their words are.
const TABLES: &[(&str, &str)] = &[
    ("a keyword of IEC 61131-3", KEYWORDS),
    ("a type of IEC 61131-3", TYPES),
    ("a standard function of IEC 61131-3", FUNCTIONS),
    ("a standard function block of IEC 61131-3", BLOCKS),
    ("a keyword or operator of CODESYS and TwinCAT", CODESYS),
    ("a flag that CODESYS and TwinCAT give every SFC", SFC_FLAGS),
    ("a block in the library of Beremiz", LIBRARY),
    ("a word that Beremiz needs in the C code that it makes", MACROS),
    ("a word of C, of which Beremiz makes the program", C),
];

/// Keywords that the scanner of Beremiz' compiler matiec looks for in the middle of names too, to find where what it
/// passes over ends. Longer ones (`END_FUNCTION_BLOCK`) hold a shorter one.
const ENDS: [&str; 5] = ["END_PROGRAM", "END_FUNCTION", "END_CONFIGURATION", "END_TRANSITION", "END_ACTION"];

/// Keywords of textual and graphical languages, operators of IL and qualifiers of actions: IEC 61131-3, editions 2 (annex C)
/// and 3 (table 4).
const KEYWORDS: &str = "
    ABSTRACT ACTION AND ANDN ARRAY AT BY CAL CALC CALCN CASE CLASS CLK CONFIGURATION CONSTANT CONTINUE D
    DO DS ELSE ELSIF EN END_ACTION END_CASE END_CLASS END_CONFIGURATION END_FOR END_FUNCTION
    END_FUNCTION_BLOCK END_IF END_INTERFACE END_METHOD END_NAMESPACE END_PROGRAM END_REPEAT END_RESOURCE
    END_STEP END_STRUCT END_TRANSITION END_TYPE END_VAR END_WHILE ENO EXIT EXTENDS FALSE FBD FINAL FOR
    FROM FUNCTION FUNCTION_BLOCK F_EDGE IF IL IMPLEMENTS INITIAL_STEP INTERFACE INTERNAL INTERVAL JMP
    JMPC JMPCN L LD LDN METHOD MOD N NAMESPACE NON_RETAIN NOT NULL OF OR ORN OVERLAP OVERRIDE P P0 P1
    PRIORITY PRIVATE PROGRAM PROTECTED PUBLIC R READ_ONLY READ_WRITE REF REF_TO REPEAT RESOURCE RET
    RETAIN RETC RETCN RETURN R_EDGE S SD SFC SINGLE SL ST STEP STN STRUCT SUPER T TASK THEN THIS TO
    TRANSITION TRUE TYPE UNTIL USING VAR VAR_ACCESS VAR_CONFIG VAR_EXTERNAL VAR_GLOBAL VAR_INPUT
    VAR_IN_OUT VAR_OUTPUT VAR_TEMP WHILE WITH XOR XORN
";

/// Elementary and generic types: IEC 61131-3, editions 2 (tables 10 and 11) and 3 (tables 10 and 11).
const TYPES: &str = "
    ANY ANY_BIT ANY_CHAR ANY_CHARS ANY_DATE ANY_DERIVED ANY_DURATION ANY_ELEMENTARY ANY_INT
    ANY_MAGNITUDE ANY_NUM ANY_REAL ANY_SIGNED ANY_STRING ANY_UNSIGNED BOOL BYTE CHAR DATE DATE_AND_TIME
    DINT DT DWORD INT LDATE LDATE_AND_TIME LDT LINT LREAL LTIME LTIME_OF_DAY LTOD LWORD REAL SINT STRING
    TIME TIME_OF_DAY TOD UDINT UINT ULINT USINT WCHAR WORD WSTRING
";

/// Standard functions: IEC 61131-3, edition 3, tables 22 to 42. [`typed`] holds their forms for one type.
const FUNCTIONS: &str = "
    ABS ACOS ADD ADD_DT_TIME ADD_LDT_LTIME ADD_LTIME ADD_LTOD_LTIME ADD_TIME ADD_TOD_TIME ASIN ATAN
    ATAN2 CONCAT CONCAT_DATE CONCAT_DATE_LTOD CONCAT_DATE_TOD CONCAT_DT CONCAT_LDT CONCAT_LTOD
    CONCAT_TOD COS DAY_OF_WEEK DELETE DIV DIVTIME DIV_LTIME DIV_TIME EQ EXP EXPT FIND FROM_BIG_ENDIAN
    FROM_LITTLE_ENDIAN GE GT INSERT IS_VALID IS_VALID_BCD LE LEFT LEN LIMIT LN LOG LOWER_BOUND LT MAX
    MID MIN MOVE MUL MULTIME MUL_LTIME MUL_TIME MUX NE REPLACE RIGHT ROL ROR SEL SHL SHR SIN SPLIT_DATE
    SPLIT_DT SPLIT_LDT SPLIT_LTOD SPLIT_TOD SQRT SUB SUB_DATE_DATE SUB_DT_DT SUB_DT_TIME SUB_LDATE_LDATE
    SUB_LDT_LDT SUB_LDT_LTIME SUB_LTIME SUB_LTOD_LTIME SUB_LTOD_LTOD SUB_TIME SUB_TOD_TIME SUB_TOD_TOD
    TAN TO_BIG_ENDIAN TO_LITTLE_ENDIAN TRUNC UPPER_BOUND
";

/// Standard functions and blocks that have a form for each type: IEC 61131-3, edition 2, 2.5.1.4, and edition 3.
const OVERLOADED: &str = "
    ABS ACOS ADD AND ASIN ATAN COS CTD CTU CTUD DIV DIVTIME EQ EXP EXPT GE GT LE LIMIT LN LOG LT MAX MIN MOD MOVE MUL
    MULTIME MUX NE NOT OR ROL ROR SEL SHL SHR SIN SQRT SUB TAN TOF TON TP XOR
";

/// Standard function blocks: IEC 61131-3, editions 2 and 3; `RTC` and `SEMA` stand in edition 2 only.
const BLOCKS: &str = "
    CTD CTU CTUD F_TRIG RS RTC R_TRIG SEMA SR TOF TON TP
";

/// Blocks in the library of matiec, the compiler of Beremiz, beyond the standard: the manual of matiec, "standard library".
const LIBRARY: &str = "
    DERIVATIVE HYSTERESIS INTEGRAL PID RAMP
";

/// Words that the C which matiec makes has a meaning of its own for: macros of its headers, of `beremiz.h`, which stands
/// before each of them, and of `plc_debug.c`, which lists all variables for the debugger of Beremiz, with what it can be
/// told to leave out. Names go there in upper case.
const MACROS: &str = "
    BUFFER_EMPTY BUFFER_FULL DBG DBG_TYPE EN_ENO EN_ENO_PARAMS EPOCH_YEAR FB FORCE_BUFFER_SIZE FORCE_LIST_SIZE
    IEC_TYPES_ALL_H IEC_TYPES_H LOCATED LOG_CRITICAL LOG_DEBUG LOG_INFO LOG_LEVELS LOG_WARNING ON
    PLC_THREAD_PRIORITY REALTIME_LINUX TRACE_BUFFER_SIZE TRACE_LIST_SIZE
    TARGET_DEBUG_AND_RETAIN_DISABLE TARGET_EXT_SYNC_DISABLE TARGET_LOGGING_DISABLE TARGET_ONLINE_DEBUG_DISABLE
    SECONDS_PER_DAY SECONDS_PER_HOUR SECONDS_PER_MINUTE STR_LEN_TYPE STR_MAX_LEN T TEST_EN TEST_EN_COND
    VA_ARGS_BOOL VA_ARGS_BYTE VA_ARGS_DATE VA_ARGS_DINT VA_ARGS_DT VA_ARGS_DWORD VA_ARGS_INT
    VA_ARGS_LINT VA_ARGS_LREAL VA_ARGS_LWORD VA_ARGS_REAL VA_ARGS_SINT VA_ARGS_STRING VA_ARGS_TIME
    VA_ARGS_TOD VA_ARGS_UDINT VA_ARGS_UINT VA_ARGS_ULINT VA_ARGS_USINT VA_ARGS_WORD VA_ARGS_WSTRING X
";

/// Macros in upper case that standard headers of C define, which that C includes: ISO C (`limits.h`, `float.h`, `math.h`,
/// `stdint.h`, `stdio.h`, `stdlib.h`, `time.h`), POSIX.1-2008, the System V names of `math.h`, and what compilers for Windows predefine.
const C: &str = "
    AIO_PRIO_DELTA_MAX BC_BASE_MAX BC_DIM_MAX BC_SCALE_MAX BC_STRING_MAX BIG_ENDIAN BUFSIZ BYTE_ORDER
    CHARCLASS_NAME_MAX CHAR_BIT CHAR_MAX CHAR_MIN CLK_TCK CLOCKS_PER_SEC CLOCK_BOOTTIME
    CLOCK_BOOTTIME_ALARM CLOCK_MONOTONIC CLOCK_MONOTONIC_COARSE CLOCK_MONOTONIC_RAW
    CLOCK_PROCESS_CPUTIME_ID CLOCK_REALTIME CLOCK_REALTIME_ALARM CLOCK_REALTIME_COARSE CLOCK_TAI
    CLOCK_THREAD_CPUTIME_ID COLL_WEIGHTS_MAX DBL_DECIMAL_DIG DBL_DIG DBL_EPSILON DBL_HAS_SUBNORM
    DBL_MANT_DIG DBL_MAX DBL_MAX_10_EXP DBL_MAX_EXP DBL_MIN DBL_MIN_10_EXP DBL_MIN_EXP DBL_TRUE_MIN
    DECIMAL_DIG DELAYTIMER_MAX DOMAIN EOF EXIT_FAILURE EXIT_SUCCESS EXPR_NEST_MAX FALSE FD_CLR FD_ISSET
    FD_SET FD_SETSIZE FD_ZERO FILENAME_MAX FLT_DECIMAL_DIG FLT_DIG FLT_EPSILON FLT_EVAL_METHOD
    FLT_HAS_SUBNORM FLT_MANT_DIG FLT_MAX FLT_MAX_10_EXP FLT_MAX_EXP FLT_MIN FLT_MIN_10_EXP FLT_MIN_EXP
    FLT_RADIX FLT_ROUNDS FLT_TRUE_MIN FOPEN_MAX FP_ILOGB0 FP_ILOGBNAN FP_INFINITE FP_NAN FP_NORMAL
    FP_SUBNORMAL FP_ZERO HOST_NAME_MAX HUGE_VAL HUGE_VALF HUGE_VALL INFINITY INT16_C INT16_MAX INT16_MIN
    INT32_C INT32_MAX INT32_MIN INT64_C INT64_MAX INT64_MIN INT8_C INT8_MAX INT8_MIN INTMAX_C INTMAX_MAX
    INTMAX_MIN INTPTR_MAX INTPTR_MIN INT_FAST16_MAX INT_FAST16_MIN INT_FAST32_MAX INT_FAST32_MIN
    INT_FAST64_MAX INT_FAST64_MIN INT_FAST8_MAX INT_FAST8_MIN INT_LEAST16_MAX INT_LEAST16_MIN
    INT_LEAST32_MAX INT_LEAST32_MIN INT_LEAST64_MAX INT_LEAST64_MIN INT_LEAST8_MAX INT_LEAST8_MIN
    INT_MAX INT_MIN LDBL_DECIMAL_DIG LDBL_DIG LDBL_EPSILON LDBL_HAS_SUBNORM LDBL_MANT_DIG LDBL_MAX
    LDBL_MAX_10_EXP LDBL_MAX_EXP LDBL_MIN LDBL_MIN_10_EXP LDBL_MIN_EXP LDBL_TRUE_MIN LINE_MAX
    LITTLE_ENDIAN LLONG_MAX LLONG_MIN LOGIN_NAME_MAX LONG_MAX LONG_MIN MATH_ERREXCEPT MATH_ERRNO
    MAXFLOAT MAX_CANON MAX_INPUT MB_CUR_MAX MB_LEN_MAX MQ_PRIO_MAX M_1_PI M_2_PI M_2_SQRTPI M_E M_LN10
    M_LN2 M_LOG10E M_LOG2E M_PI M_PI_2 M_PI_4 M_SQRT1_2 M_SQRT2 NAME_MAX NAN NFDBITS NGROUPS_MAX NULL
    OVERFLOW PATH_MAX PDP_ENDIAN PIPE_BUF PLOSS PTHREAD_DESTRUCTOR_ITERATIONS PTHREAD_KEYS_MAX
    PTHREAD_STACK_MIN PTRDIFF_MAX PTRDIFF_MIN RAND_MAX RE_DUP_MAX RTSIG_MAX SCHAR_MAX SCHAR_MIN SEEK_CUR
    SEEK_END SEEK_SET SEM_VALUE_MAX SHRT_MAX SHRT_MIN SIG_ATOMIC_MAX SIG_ATOMIC_MIN SING SIZE_MAX
    SSIZE_MAX TIMER_ABSTIME TIME_UTC TLOSS TMP_MAX TRUE TTY_NAME_MAX UCHAR_MAX UINT16_C UINT16_MAX
    UINT32_C UINT32_MAX UINT64_C UINT64_MAX UINT8_C UINT8_MAX UINTMAX_C UINTMAX_MAX UINTPTR_MAX
    UINT_FAST16_MAX UINT_FAST32_MAX UINT_FAST64_MAX UINT_FAST8_MAX UINT_LEAST16_MAX UINT_LEAST32_MAX
    UINT_LEAST64_MAX UINT_LEAST8_MAX UINT_MAX ULLONG_MAX ULONG_MAX UNDERFLOW USHRT_MAX WCHAR_MAX
    WCHAR_MIN WCONTINUED WEXITED WEXITSTATUS WIFCONTINUED WIFEXITED WIFSIGNALED WIFSTOPPED WIN32 WIN64
    WINNT WINT_MAX WINT_MIN WNOHANG WNOWAIT WSTOPPED WSTOPSIG WTERMSIG WUNTRACED XATTR_LIST_MAX
    XATTR_NAME_MAX XATTR_SIZE_MAX X_TLOSS
";

/// Keywords and operators beyond the standard: CODESYS Development System, help pages "Keywords", "Operators" and
/// "Compiler Error C0543"; Beckhoff Information System, TwinCAT 3 PLC, "Keywords" and "Operators".
const CODESYS: &str = "
    ADR ADRINST AND_THEN BIT BITADR CHAR_TO END_PROPERTY END_UNION INDEXOF INI OR_ELSE PARAMS PERSISTENT
    POINTER PROPERTY REFERENCE SIZEOF TEST_AND_SET TO_CHAR TO_WCHAR TRUNC_INT UNION UXINT VAR_GENERIC
    VAR_INST VAR_STAT WCHAR_TO XADD XINT XSIZEOF XWORD
";

/// Those of them that are types, which are converted like others: `TO_BIT`, `XWORD_TO_DWORD` (the pages "Type Conversion
/// Operators" of both).
const CODESYS_TYPES: &str = "BIT UXINT XINT XWORD";

/// Flags that every SFC has: the help pages "SFC Flags" of both.
const SFC_FLAGS: &str = "
    SFCCURRENTSTEP SFCENABLELIMIT SFCERROR SFCERRORANALYZATION SFCERRORANALYZATIONTABLE SFCERRORPOU
    SFCERRORSTEP SFCINIT SFCPAUSE SFCQUITERROR SFCRESET SFCTIP SFCTIPMODE SFCTRANS
";
