//! What several items need and one computes.

use super::ReproduceError;
use std::sync::{Arc, Mutex, PoisonError};

/// Results by key. Not locked while one is computed: the solver's threads may take up an item that asks for the same, which then
/// computes it, too.
#[derive(Debug)]
pub(super) struct Shared<K, V>(Mutex<Vec<(K, Arc<V>)>>);

impl<K, V> Default for Shared<K, V> {
    fn default() -> Self {
        Shared(Mutex::new(Vec::new()))
    }
}

impl<K: PartialEq, V> Shared<K, V> {
    /// The result of a key, computed where there is none yet.
    pub fn get(
        &self,
        key: K,
        compute: impl FnOnce() -> Result<V, ReproduceError>,
    ) -> Result<Arc<V>, ReproduceError> {
        let known = |all: &Vec<(K, Arc<V>)>| all.iter().find(|(k, _)| *k == key).map(|(_, v)| v.clone());
        if let Some(found) = known(&self.0.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(found);
        }
        let made = Arc::new(compute()?);
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(known(&all).unwrap_or_else(|| {
            all.push((key, made.clone()));
            made
        }))
    }
}
