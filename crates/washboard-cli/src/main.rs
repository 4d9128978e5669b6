//! The command line of washboard.
fn main() {}
