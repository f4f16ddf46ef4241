//! Order, factor and solve of L + M on sphere-like graphs.
fn main() {}
