/* Calls `done` with the seconds that were played once a film has ended that was played at its own pace and without a gap, as the browser */
/* itself counts it: a slow browser tells of it late. */
const gate = (film, done) => {
  const far = () => { let end = 0; for (let part = 0; part < film.played.length; part += 1) if (film.played.start(part) <= end + 0.3) end = Math.max(end, film.played.end(part)); return end; };
  film.addEventListener('ratechange', () => { if (film.playbackRate !== 1) film.playbackRate = 1; });
  film.addEventListener('seeking', () => { if (film.currentTime > far() + 0.3) film.currentTime = far(); });
  film.addEventListener('ended', () => { if (far() > film.duration - 0.5) done(Math.round(far() * 10) / 10); });
};
