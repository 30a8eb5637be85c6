//! What must hold of the tables: a rule a row, each with the question that finds what breaks it.
//!
//! The questions stand on three tables that [`super::audit`] makes beside the store for the time of a look: `source(job, role, parent)`, the jobs
//! that a job's inputs come from, `brief(job, scenario, stage, state)`, jobs by scenario, and `said(job, seq, state)`, the newest entry of the
//! outbox about each job.

/// A rule.
#[derive(Debug)]
pub(super) struct Rule {
    /// Its name, in reports and for programs.
    pub(super) name: &'static str,
    /// What must hold, as a sentence without its period.
    pub(super) about: &'static str,
    /// The question for how many things it is about.
    pub(super) looked_at: &'static str,
    /// The question for what breaks it: a sentence each.
    pub(super) wrong: &'static str,
}

/// The rules by which bodies can be read at all; where one is broken, the others are not looked at.
pub(super) const READABLE: [Rule; 1] = [Rule {
    name: "readable",
    about: "every row can be read",
    looked_at: "select (select count(*) from scenario) + (select count(*) from job) + (select count(*) from attempt) + \
                (select count(*) from result) + (select count(*) from event) + (select count(*) from batch) + \
                (select count(*) from series)",
    wrong: "select 'the row of scenario `' || id || '` is no JSON' from scenario where not json_valid(body) \
            union all select 'the row of job `' || job || '` is no JSON' from job where not json_valid(body) \
            union all select 'the row of attempt ' || number || ' of `' || job || '` is no JSON' from attempt where not json_valid(body) \
            union all select 'the result of `' || job || '` is no JSON' from result where not json_valid(body) \
            union all select 'the row of batch `' || name || '` is no JSON' from batch where not json_valid(body) \
            union all select 'the series from place ' || place || ' on is no JSON' from series where not json_valid(body) \
            union all select 'entry ' || seq || ' of the outbox is no JSON' from event where not json_valid(body)",
}];

/// All other rules, in the order in which they are told.
pub(super) const RULES: [Rule; 17] = [
    Rule {
        name: "once",
        about: "every scenario, job, attempt, result and dead letter is there once",
        looked_at: "select (select count(*) from scenario) + (select count(*) from job) + (select count(*) from attempt) + \
                    (select count(*) from result) + (select count(*) from dead)",
        wrong: "select 'scenario `' || id || '` is there ' || count(*) || ' times' from scenario group by id having count(*) > 1 \
                union all select 'job `' || job || '` is there ' || count(*) || ' times' from job group by job having count(*) > 1 \
                union all select 'attempt ' || number || ' of `' || job || '` is there ' || count(*) || ' times' \
                    from attempt group by job, number having count(*) > 1 \
                union all select 'job `' || job || '` has ' || count(*) || ' results' from result group by job having count(*) > 1 \
                union all select 'job `' || job || '` has ' || count(*) || ' dead letters' from dead group by job having count(*) > 1",
    },
    Rule {
        name: "owner",
        about: "every row belongs to something that is there",
        looked_at: "select (select count(*) from job) + (select count(*) from attempt) + (select count(*) from result) + \
                    (select count(*) from dead) + (select count(*) from source)",
        wrong: "select 'job `' || job || '` belongs to scenario `' || scenario || '`, which is not there' \
                    from job where scenario not in (select id from scenario) \
                union all select 'attempt ' || number || ' belongs to job `' || job || '`, which is not there' \
                    from attempt where job not in (select job from job) \
                union all select 'a result belongs to job `' || job || '`, which is not there' \
                    from result where job not in (select job from job) \
                union all select 'a dead letter belongs to job `' || job || '`, which is not there' \
                    from dead where job not in (select job from job) \
                union all select 'job `' || job || '` takes its ' || role || ' from `' || parent || '`, which is not there' \
                    from source where parent not in (select job from job)",
    },
    Rule {
        name: "columns",
        about: "the columns of a row say what its body says",
        looked_at: "select (select count(*) from scenario) + (select count(*) from job) + (select count(*) from attempt) + \
                    (select count(*) from result)",
        wrong: "select 'scenario `' || id || '` ended as `' || coalesce(result, 'open') || '` by its column, as `' || \
                    coalesce(json_extract(body, '$.end'), 'open') || '` by its body' from scenario \
                    where result is not json_extract(body, '$.end') and json_type(body, '$.end') is not 'object' \
                union all select 'job `' || job || '` is ' || state || ' by its column, ' || \
                    coalesce(json_extract(body, '$.state'), 'nothing') || ' by its body' \
                    from job where state is not json_extract(body, '$.state') \
                union all select 'attempt ' || number || ' of `' || job || '` has fence ' || fence || ' by its column, ' || \
                    coalesce(json_extract(body, '$[1].fence'), 'none') || ' by its body' \
                    from attempt where fence is not json_extract(body, '$[1].fence') \
                union all select 'attempt ' || number || ' of `' || job || '` ended as `' || coalesce(outcome, 'open') || \
                    '` by its column, as `' || coalesce(json_extract(body, '$[1].end'), 'open') || '` by its body' from attempt \
                    where outcome is not replace(json_extract(body, '$[1].end'), '_', '') \
                union all select 'the result of `' || job || '` is of attempt ' || attempt || ' by its column, ' || \
                    coalesce(json_extract(body, '$[1].attempt'), 'none') || ' by its body' \
                    from result where attempt is not json_extract(body, '$[1].attempt')",
    },
    Rule {
        name: "place",
        about: "scenarios are numbered in the order of their submission, without a gap",
        looked_at: "select count(*) from scenario",
        wrong: "select 'place ' || place || ' is taken ' || count(*) || ' times' from scenario group by place having count(*) > 1 \
                union all select 'place ' || (place - 1) || ' of the scenarios is empty' from scenario \
                    where place > 0 and place - 1 not in (select place from scenario) \
                    and not exists (select 1 from series where scenario.place - 1 >= series.place \
                        and scenario.place - 1 < series.place + series.count)",
    },
    Rule {
        name: "series",
        about: "the scenarios of a series that are made are its first ones, in its batch and none that is left out, and no two series overlap",
        looked_at: "select count(*) from series",
        wrong: "select 'scenario `' || id || '` is made, and the one before it in its series is not' from scenario join series \
                    on scenario.place > series.place and scenario.place < series.place + series.count \
                    where scenario.place - 1 not in (select place from scenario) \
                union all select 'scenario `' || id || '` is made, and its series leaves it out' from scenario join series \
                    on scenario.place >= series.place + series.count - series.left_out and scenario.place < series.place + series.count \
                union all select 'scenario `' || id || '` is of batch `' || scenario.batch || '`, its series of `' || series.batch || '`' \
                    from scenario join series on scenario.place >= series.place and scenario.place < series.place + series.count \
                    where scenario.batch != series.batch \
                union all select 'the series from place ' || later.place || ' on begins in the one from place ' || earlier.place || ' on' \
                    from series as earlier join series as later on later.place > earlier.place \
                    and later.place < earlier.place + earlier.count",
    },
    Rule {
        name: "scenario-end",
        about: "a scenario has ended when, and only when, none of its jobs is open",
        looked_at: "select count(*) from scenario",
        wrong: "select 'scenario `' || id || '` ended as `' || result || '` with open jobs' from scenario where result is not null \
                    and exists (select 1 from brief where brief.scenario = id \
                        and state in ('blocked', 'ready', 'delayed', 'leased', 'canceling')) \
                union all select 'scenario `' || id || '` has not ended, and none of its jobs is open' from scenario where result is null \
                    and not exists (select 1 from brief where brief.scenario = id \
                        and state in ('blocked', 'ready', 'delayed', 'leased', 'canceling'))",
    },
    Rule {
        name: "scenario-moves",
        about: "a scenario that has not ended has a job that moves it, and a blocked job waits for an open one",
        looked_at: "select (select count(*) from scenario where result is null) + (select count(*) from job where state = 'blocked')",
        wrong: "select 'scenario `' || id || '` is open, and nothing moves it: all its open jobs are blocked' from scenario \
                    where result is null and exists (select 1 from brief where brief.scenario = id and state = 'blocked') \
                    and not exists (select 1 from brief where brief.scenario = id and state in ('ready', 'delayed', 'leased', 'canceling')) \
                union all select 'job `' || job || '` is blocked, and all it waits for has ended' from job where state = 'blocked' \
                    and not exists (select 1 from source join brief as before on before.job = source.parent \
                        where source.job = job.job and before.state in ('blocked', 'ready', 'delayed', 'leased', 'canceling'))",
    },
    Rule {
        name: "scenario-verdict",
        about: "a verdict of a scenario is that of one of its scoring jobs",
        looked_at: "select count(*) from scenario where result not in ('failed', 'canceled')",
        wrong: "select 'scenario `' || id || '` ended as `' || result || '`, and no scoring job says so' from scenario \
                    where result not in ('failed', 'canceled') and not exists (select 1 from brief join result as made \
                        on made.job = brief.job where brief.scenario = id and brief.stage = 'scoring' \
                        and coalesce(made.verdict, 'invalid') = scenario.result)",
    },
    Rule {
        name: "result-or-dead",
        about: "a job that succeeded has one result, one that failed or died one dead letter, and any other neither",
        looked_at: "select count(*) from job",
        wrong: "select 'job `' || job || '` succeeded and has no result' from job \
                    where state = 'succeeded' and job not in (select job from result) \
                union all select 'job `' || job || '` is ' || state || ' and has a result' from job \
                    where state != 'succeeded' and job in (select job from result) \
                union all select 'job `' || job || '` is ' || state || ' and has no dead letter' from job \
                    where state in ('failed', 'dead') and job not in (select job from dead) \
                union all select 'job `' || job || '` is ' || state || ' and has a dead letter' from job \
                    where state not in ('failed', 'dead') and job in (select job from dead)",
    },
    Rule {
        name: "result-attempt",
        about: "a result is of the one attempt that succeeded, or was taken over from a job with the same key",
        looked_at: "select (select count(*) from result) + (select count(*) from attempt where outcome = 'succeeded')",
        wrong: "select 'the result of `' || result.job || '` is of attempt ' || result.attempt || ', which ' || \
                    case when attempt.job is null then 'is not there' else 'ended as `' || coalesce(attempt.outcome, 'open') || '`' end \
                    from result left join attempt on attempt.job = result.job and attempt.number = result.attempt \
                    where result.attempt > 0 and attempt.outcome is not 'succeeded' \
                union all select 'attempt ' || number || ' of `' || attempt.job || '` succeeded, and the result is not its own' \
                    from attempt where outcome = 'succeeded' \
                    and not exists (select 1 from result where result.job = attempt.job and result.attempt = attempt.number) \
                union all select 'the result of `' || job || '` was taken over, and no job made one with its key' from result \
                    where attempt = 0 and json_extract(body, '$[1].idem_key') not in \
                        (select json_extract(body, '$[1].idem_key') from result where attempt > 0)",
    },
    Rule {
        name: "inputs",
        about: "a job that is handed out, waits for it or succeeded has what it needs",
        looked_at: "select count(*) from source",
        wrong: "select 'job `' || job.job || '` is ' || job.state || ' without the result of `' || source.parent || '`' \
                    from job join source on source.job = job.job where job.state in ('ready', 'delayed', 'leased', 'succeeded') \
                    and source.role not in ('reference', 'twin') and source.parent not in (select job from result)",
    },
    Rule {
        name: "attempt-number",
        about: "the attempts of a job are numbered from 1 without a gap",
        looked_at: "select count(*) from attempt",
        wrong: "select 'attempt ' || (number - 1) || ' of `' || job || '` lacks before attempt ' || number from attempt as later \
                    where number != 1 and not exists (select 1 from attempt \
                        where attempt.job = later.job and attempt.number = later.number - 1)",
    },
    Rule {
        name: "attempt-open",
        about: "a job has one open attempt, its last, while a worker has it, and none else",
        looked_at: "select count(*) from job",
        wrong: "select 'job `' || job.job || '` is ' || job.state || ' and has ' || count(number) || ' open attempts' \
                    from job left join attempt on attempt.job = job.job and attempt.outcome is null group by job.job \
                    having count(number) != (job.state in ('leased', 'canceling')) \
                union all select 'attempt ' || number || ' of `' || job || '` is open, and a later one was begun' from attempt as open \
                    where outcome is null and exists (select 1 from attempt \
                        where attempt.job = open.job and attempt.number > open.number)",
    },
    Rule {
        name: "fence",
        about: "the fences of a job grow, and no two attempts share one",
        looked_at: "select count(*) from attempt",
        wrong: "select 'attempt ' || number || ' of `' || job || '` has fence ' || fence || ', not above ' || before || ' of the one before' \
                    from (select job, number, fence, lag(fence) over (partition by job order by number) as before from attempt) \
                    where before >= fence \
                union all select 'fence ' || fence || ' was given to ' || count(*) || ' attempts' from attempt \
                    group by fence having count(*) > 1",
    },
    Rule {
        name: "outbox",
        about: "the entries of the outbox are numbered without a gap",
        looked_at: "select count(*) from event",
        wrong: "select 'the outbox has no entries from ' || (before + 1) || ' to ' || (seq - 1) \
                    from (select seq, lag(seq) over (order by seq) as before from event) where seq != before + 1",
    },
    Rule {
        name: "outbox-newest",
        about: "the newest entry of the outbox about a job says what its row says",
        looked_at: "select count(*) from said",
        wrong: "select 'job `' || job.job || '` is ' || job.state || ', and entry ' || said.seq || ' of the outbox told last that it is ' || \
                    said.state from job join said on said.job = job.job where said.state != job.state \
                union all select 'job `' || job.job || '` is ' || job.state || ', and the outbox tells nothing of it' from job \
                    where job.state != 'blocked' and (select min(seq) from event) = 1 and job.job not in (select job from said)",
    },
    Rule {
        name: "report",
        about: "an attempt that succeeded or failed has its worker's report",
        looked_at: "select count(*) from attempt where outcome in ('succeeded', 'failed')",
        wrong: "select 'attempt ' || number || ' of `' || job || '` ' || outcome || ' without a report' from attempt \
                    where outcome in ('succeeded', 'failed') and not json_extract(body, '$[1].reported')",
    },
];
