"""Recomputes the stored trajectories, or those named, and prints how far they are from the stored ones."""

import sys
import time

import trajectories
import excitation


def main(names):
    print(f"{'case':26}{'events':>14}{'theta/alpha':>13}{'times, s':>10}{'others':>10}{'CPU, s':>8}")
    open_, skipped, wrong = 0, [], []
    for folder in trajectories.FOLDERS:
        for case in trajectories.cases(folder):
            name = case["name"]
            if names and name not in names:
                continue
            began = time.process_time()
            try:
                found = trajectories.compare(folder, case)
            except excitation.Missing as record:
                skipped.append(f"{name} ({record})")
                continue
            open_ += 1
            events = f"{found.events} differ" if found.wrong else f"{found.events} equal"
            seconds = time.process_time() - began
            print(f"{name:26}{events:>14}{found.theta:13.1e}{found.times:10.1e}{found.others:10.1e}{seconds:8.1f}", flush=True)
            if found.wrong:
                wrong.append(f"{name}: {found.wrong}")
    print(f"{open_} recomputed")
    if skipped:
        print(f"{len(skipped)} skipped, whose records may not be redistributed: {', '.join(skipped)}")
    for line in wrong:
        print(line)
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
