"""The local app, `tol3d app`: a scene in the browser, its tolerances moved by hand, and what that does seen at once.

    folder       scenes, runs, what may be read    workspace.py    Workspace
    session      text -> scene -> response, draws  session.py      Session
    live         estimate at once, then solid      live.py         Live
    place        .tol3d/app/, one app writes       place.py        FolderLock
    jobs         runs and analyses in children     jobs.py         Jobs            (standing.py; a child: job.py)
    analyses     forms -> arguments of jobs        forms.py        form            (words.py: which arguments)
    answers      kept, shown again                 answer.py       kept_answer
    runs         listed, deleted                   made_runs.py    runs_of
    page         card, tree, builds as HTML        card.py, tree.py, builds.py
    requests     who may ask what                  guard.py, server.py (questions.py, folder_questions.py)

The scene's file is the truth: what is not kept there is a what-if, a few numbers beside it. Every number of the card is
made by the code that makes a run's. It knows public names of tol3d alone, and nothing imports it.
"""
