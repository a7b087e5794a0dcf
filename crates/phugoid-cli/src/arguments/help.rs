//! The text below every help page.

pub(crate) const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  the task has no answer (no such trim, a case that cannot be run), or `phugoid estimate` refuses
     its result, which is printed and written all the same, or `phugoid check` found a value that is
     not within its tolerance
  2  wrong command line
  3  an input (file, name, budget) is unknown, cannot be read or is wrong
  4  a result cannot be written
  5  the flight holds nothing that could be estimated: too few samples, nothing that moves,
     parameters that do nothing; what SMPE and the EKF print of such a flight was known before
  6  the search of a batch method did not converge
 10  `phugoid monitor`: the aircraft has diverged from what is expected";

/// The examples of a command, two spaces before each line, and the exit codes of the program after them.
pub(super) fn examples_and_exit_codes(examples: &str) -> String {
    format!("Examples:\n{examples}\n\n{EXIT_CODES}")
}
