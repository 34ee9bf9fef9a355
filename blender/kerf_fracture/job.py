"""Work in a thread of its own, which Blender's main thread watches and may stop."""

import threading

from .backend import Stopped


class Job:
    """Calls work(item, progress) for each item. `outcomes` has what it returned or the exception that it threw."""

    def __init__(self, items, work):
        self.items, self.work = list(items), work
        self.outcomes, self.words, self.fraction = [], "", 0.0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self.run, daemon=True)

    def start(self):
        self._thread.start()

    def running(self):
        return self._thread.is_alive()

    def stop(self):
        """Stops the work. A step that reports no progress for two seconds is left to end by itself; its result is dropped."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(2)

    def stopped(self):
        """Whether the work has ended because it was stopped."""
        return any(isinstance(outcome, Stopped) for outcome in self.outcomes)

    def run(self):
        for number, item in enumerate(self.items):

            def progress(words, fraction, number=number):
                self.words, self.fraction = words, (number + fraction) / len(self.items)
                return not self._stop.is_set()

            try:
                outcome = self.work(item, progress)
                if self._stop.is_set():
                    raise Stopped()
                self.outcomes.append(outcome)
            except Exception as error:  # the main thread reports it
                self.outcomes.append(error)
                if isinstance(error, Stopped):
                    return
