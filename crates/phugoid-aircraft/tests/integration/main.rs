//! Integration tests: one program, since each is linked with every library again.

mod jsbsim;
