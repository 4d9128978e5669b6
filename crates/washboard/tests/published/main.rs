//! Published numbers: each test names its source, table and tolerance (the printed digits).

#![allow(clippy::unwrap_used)]

mod interaction;
mod modes;
mod ride;
