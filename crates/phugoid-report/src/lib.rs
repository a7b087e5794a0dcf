//! Figures and self-contained HTML reports of an estimation.
