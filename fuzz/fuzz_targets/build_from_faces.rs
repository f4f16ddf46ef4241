//! Fuzzes `dgp_tests::fuzz::build_from_faces`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dgp_tests::fuzz::build_from_faces(bytes));
