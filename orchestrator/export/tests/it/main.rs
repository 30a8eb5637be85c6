//! Integration tests of the exporters.

#[cfg(test)]
mod graphs;
#[cfg(test)]
mod hard;
#[cfg(test)]
mod kits;
#[cfg(test)]
mod scenarios;
#[cfg(test)]
mod simulators;
#[cfg(test)]
mod whole;
#[cfg(test)]
mod worlds;
