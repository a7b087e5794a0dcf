/// The same cases in every run: what CI tries today it tries tomorrow.
fn runner(cases: u32) -> TestRunner {
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[17; 32]))
}

fn read(text: &[u8]) -> Result<Record, csv::ReadError> {
    csv::read(text, "generated", &CsvOptions::default())
