//! With programs of others: browsers, servers of models, other users, terminals. The second ring of the gate runs these with
//! everything installed; elsewhere what is missing is left out and named.

mod bags;
mod built;
mod consoles;
mod deploy;
mod drivers;
mod editors;
mod exports;
mod graphs;
mod live;
mod looks;
pub(crate) mod models;
mod observers;
mod python;
mod readers;
mod strangers;
mod studies;
mod surveys;
mod terminals;
