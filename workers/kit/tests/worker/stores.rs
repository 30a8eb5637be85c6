//! Workers whose orchestrator goes, and one of another job store answers.

use super::*;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_of_a_late_reign_serves_a_fresh_store_and_brings_nothing_along() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        rig.office.lock().unwrap().reigns = 2;
        let worker = rig.worker(WorkerConfig { slots: 3, ..Rig::config(dir.path()) });
        rig.open(grant(1, "abc", "")).await;
        rig.until(|office| office.reports.len() == 1).await;
        // Held when the store goes: an attempt that runs, and a report that is not recorded.
        rig.office.lock().unwrap().lose_reports = u32::MAX;
        rig.open(grant(2, "abc", "hang")).await;
        rig.open(grant(3, "abc", "")).await;
        rig.until(|office| office.reports.len() == 2 && spooled(dir.path()) > 0).await;
        while rig.runs.load(Ordering::SeqCst) < 3 {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        // Reign 1 of another store, whose jobs have the names and numbers of the old ones.
        *rig.office.lock().unwrap() = Office { store: 1, ..Office::default() };
        for number in 1..4 {
            rig.open(grant(number, "xyz", "")).await;
        }
        rig.until(|office| office.reports.len() == 3).await;
        while spooled(dir.path()) > 0 {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        let office = rig.office.lock().unwrap();
        assert!(office.hellos == 1 && office.disowned > 0, "{} hellos, {} disowned", office.hellos, office.disowned);
        for report in &office.reports {
            assert_eq!(report.artifacts[0].inline.as_deref(), Some("zyx"), "{}", report.key);
        }
        assert_eq!(rig.runs.load(Ordering::SeqCst), 6);
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_stays_with_its_reign_while_another_store_answers_two_of_three_beats() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        rig.office.lock().unwrap().reigns = 2;
        let worker = rig.worker(Rig::config(dir.path()));
        rig.until(|office| office.beats > 1).await;
        rig.office.lock().unwrap().intruded = true;
        rig.until(|office| office.disowned > 8).await;
        rig.open(grant(1, "abc", "")).await;
        rig.until(|office| office.reports.len() == 1).await;
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        let office = rig.office.lock().unwrap();
        assert_eq!((office.hellos, office.instances.len()), (1, 1), "it never left");
    })
    .await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_worker_serves_an_older_copy_of_its_store() {
    guarded(async {
        let (rig, dir) = (Rig::new(), tempfile::tempdir().unwrap());
        rig.office.lock().unwrap().reigns = 2;
        let worker = rig.worker(Rig::config(dir.path()));
        rig.open(grant(1, "abc", "")).await;
        rig.until(|office| office.reports.len() == 1).await;
        {
            // The copy knows the first reign alone; the job is open in it.
            let mut office = rig.office.lock().unwrap();
            (office.reigns, office.hellos) = (0, 0);
            office.granted.clear();
            office.reports.clear();
        }
        rig.open(grant(1, "abc", "")).await;
        rig.until(|office| office.reports.len() == 1).await;
        rig.stop.send_replace(Stop::Drain);
        worker.await.unwrap().unwrap();
        assert_eq!((rig.office.lock().unwrap().hellos, rig.runs.load(Ordering::SeqCst)), (1, 2));
    })
    .await;
}
