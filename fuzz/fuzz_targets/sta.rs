//! Any bytes give attempts whose times are finite.
#![no_main]

use fe_driver::read_sta;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    assert!(read_sta(bytes).iter().all(|attempt| attempt.lambda.is_finite()));
});
