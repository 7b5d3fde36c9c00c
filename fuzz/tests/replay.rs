//! Every input of the corpus, and every one that once failed a target, through its target: no fuzzer needed.

use std::path::Path;

use wellspaced_fuzz::TARGETS;

/// `FUZZ_INPUT=target:file` replays that file alone.
#[test]
fn the_corpus_holds() {
    if let Ok(one) = std::env::var("FUZZ_INPUT") {
        let (name, file) = one.split_once(':').expect("target:file");
        let target = TARGETS.iter().find(|target| target.0 == name).expect("a target's name");
        target.1(&std::fs::read(file).expect("a file"));
        return;
    }
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for (name, target) in TARGETS {
        let folder = corpus.join(name);
        let mut files: Vec<_> = std::fs::read_dir(&folder)
            .expect("a folder for each target")
            .map(|entry| entry.expect("a file").path())
            .collect();
        files.sort();
        assert!(files.len() >= 20, "{}: only {} inputs", folder.display(), files.len());
        for file in files {
            let data = std::fs::read(&file).expect("a file of the corpus");
            if let Err(panic) = std::panic::catch_unwind(|| target(&data)) {
                eprintln!("{name}: {} fails", file.display());
                std::panic::resume_unwind(panic);
            }
        }
    }
}
