import os, subprocess
import pytest
@pytest.fixture
def mpirun(tmp_path):
    def run(n, *args, check=False, timeout_s=120):
        p=os.environ.get("SLIPFRONT_MPI","build/mpi/slipfront")
        env=os.environ|{"OMPI_ALLOW_RUN_AS_ROOT":"1","OMPI_ALLOW_RUN_AS_ROOT_CONFIRM":"1"}
        r=subprocess.run(["mpirun","--oversubscribe","--bind-to","none","-n",str(n),p,*map(str,args)],cwd=tmp_path,capture_output=True,text=True,timeout=timeout_s,env=env)
        if check: assert r.returncode==0,r.stderr
        return r
    return run
