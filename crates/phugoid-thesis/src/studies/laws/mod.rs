//! Studies of the printed laws: what decides whether they converge, what they cannot do, and what mends them.

mod bounds_and_start;
mod convergence;
mod draw;
mod lambda_eta;
mod lyapunov;
mod printed_lambda;
mod rank;
mod reaching;
mod sample_time;

use crate::entry::Entry;

/// Entries of the studies of the laws.
pub(crate) const ENTRIES: &[Entry] = &[
    Entry { id: "laws/reaching", title: "Reaching condition and gain of the printed law", run: reaching::run },
    Entry { id: "laws/rank", title: "Rank of the two-parameter law, and its repair", run: rank::run },
    Entry { id: "laws/lambda-eta", title: "Convergence over lambda and eta", run: lambda_eta::run },
    Entry {
        id: "laws/printed-lambda",
        title: "Each reading of the lambda of tables 4.7 and 4.8",
        run: printed_lambda::run,
    },
    Entry { id: "laws/sample-time", title: "Convergence over lambda h and the sample time", run: sample_time::run },
    Entry { id: "laws/bounds-and-start", title: "Convergence over bounds and start", run: bounds_and_start::run },
    Entry { id: "laws/lyapunov", title: "Lyapunov functions over time", run: lyapunov::run },
];
