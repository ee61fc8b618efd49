//! Golden records: their hashes are those of x86-64 and of WebAssembly, where `make wasm` runs the same
//! files.

mod common;

use babble_lab::{Record, ToJson, replay};
use common::{executor, policies};

#[test]
fn the_golden_records_give_their_hashes() {
    for text in [
        include_str!("golden/reach.json"),
        include_str!("golden/grasp.json"),
    ] {
        let record = Record::from_json(text).unwrap();
        let lab = replay(&record, policies(), executor()).unwrap();
        assert_eq!(lab.hash().unwrap(), record.hash, "{}", record.setup.env);
        assert_eq!(record.to_json().unwrap() + "\n", text);
    }
}
