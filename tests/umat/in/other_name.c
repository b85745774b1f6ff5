/* A library whose function is spelt as a compiler that keeps capitals would. */
void UMAT(double* stress) { stress[0] = 0.0; }
void my_umat_helper(double* stress) { stress[0] = 1.0; }
